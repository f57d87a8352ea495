// SPDX-License-Identifier: GPL-2.0-or-later
/// Blocks that are cut anew while a fluid goes on: its state, and the particles on their way to it.
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/coupling/particle_relay.h"
#include "lbm_solver/field/moved_record.h"
#include "protocol/wire/routing.h"
#include "tests/ranks/on_ranks.h"

namespace {

using namespace test;

Fluid fluid_on(const Decomposition& ranks, const KernelChoice& choice) {
  Fluid fluid(ranks, choice);
  add_patches(fluid);
  if (ranks.domain().dimension() == 3) add_movers(fluid);
  fluid.place(bodies_in(ranks.domain()));
  return fluid;
}

/// Blocks of a box are cut anew after an odd number of steps: the state does not depend on the
/// parity of the slots. Of those after it loads are compared; the first needs that of the step
/// before.
constexpr int kStepsBefore = 7, kStepsAfter = 4;

/// What the box does on one rank: its cells at the change and at the end, and the loads after it.
struct Alone {
  Fluid at_change, at_end;
  std::vector<std::vector<double>> loads;

  Alone(const Box& box, const KernelChoice& choice)
      : at_change(fluid_on(Decomposition(box.domain), choice)),
        at_end(fluid_on(Decomposition(box.domain), choice)) {
    for (Fluid* fluid : {&at_change, &at_end}) {
      randomise(*fluid);
      fluid->advance(kStepsBefore);
    }
    for (int step = 0; step < kStepsAfter; ++step) {
      at_end.step();
      loads.push_back(numbers(at_end.loads()));
    }
  }
};

void expect_goes_on(const Box& box, const KernelChoice& choice, const Cell3& grid,
                    const Alone& alone) {
  const auto cuts = cuts_of(box.domain, grid);
  const Decomposition equal(box.domain, MPI_COMM_WORLD, grid, cuts[0]);
  const Decomposition uneven(box.domain, MPI_COMM_WORLD, grid, cuts[1]);
  Fluid first = fluid_on(equal, choice), second = fluid_on(uneven, choice);
  randomise(first);
  first.advance(kStepsBefore);
  second.load(moved(first.save(), equal, uneven));
  const Limits limit = limits(choice.precision, grid);
  expect_same_cells(second, alone.at_change, limit.population);
  for (const auto& loads : alone.loads) {
    second.step();
    std::vector<double> sums = numbers(second.loads());
    uneven.sum(sums);
    expect_near(sums, loads, limit.load);
  }
  expect_same_cells(second, alone.at_end, 4.0 * limit.population);
  const double mass = alone.at_end.mass_in();
  const double round_off = choice.precision == Precision::Single ? 1e-6 : 1e-13;  // of long sums
  EXPECT_NEAR(second.mass_in(), mass, round_off * (1.0 + std::abs(mass)));
}

TEST(Ranks, GoOnWithOtherBlocks) {
  for (const Box& box : boxes()) {
    if (box.domain.y == Side::Periodic) continue;
    for (const Precision precision : {Precision::Double, Precision::Single}) {
      KernelChoice choice = choice_for(box.lattice, precision);
      if (box.lattice == VelocitySet::D3Q19) choice.eddies = EddyModel::Wale;
      if (box.lattice == VelocitySet::D3Q19) choice.parameters.smagorinsky = 0.1;
      const Alone alone(box, choice);
      for (const Cell3& grid : grids(box.domain)) {
        SCOPED_TRACE(name_of(box.lattice) + " on " + std::to_string(grid[0]) + " x " +
                     std::to_string(grid[1]) + " x " + std::to_string(grid[2]));
        expect_goes_on(box, choice, grid, alone);
      }
    }
  }
}

// Values of every kind come to every rank as rank 0 has them, in parts of parts.
TEST(Ranks, KnowWhatTheFirstHasSaved) {
  const Domain domain{23, 14, Side::Wall, Side::Periodic, 13, Side::Wall};
  const Decomposition ranks(domain, MPI_COMM_WORLD, choose_grid(domain, world_size()));
  Record first, inner;
  inner.set("text", std::string("ν · é"));
  inner.set("none", std::vector<double>());
  inner.set("list", std::vector<std::int64_t>{1, -2, std::int64_t{1} << 62});
  first.set("numbers", std::vector<double>{1.0 / 3.0, -0.0});
  first.set("count", std::int64_t{-7});
  first.set("real", 1e-300);
  first.set("part", inner);
  first.set("empty", Record());
  EXPECT_EQ(moved(ranks.rank() == 0 ? first : Record(), ranks, ranks), first);
}

protocol::Hello hello_of(const Domain& domain, const Units& units) {
  protocol::Hello hello;
  hello.dimension = static_cast<std::uint32_t>(domain.dimension());
  for (int k = 0; k < 3; ++k) {
    hello.box_lo[k] = units.origin[k];
    hello.box_hi[k] = units.origin[k] + units.dx * domain.cells()[k];
    hello.periodic[k] = domain.sides()[k] == Side::Periodic;
  }
  hello.reach = 1.5 * units.dx;
  return hello;
}

/// Grains anywhere, some beyond a wall or a periodic side, and a clump of two spheres.
std::vector<protocol::Particle> grains_in(const Domain& domain, const Units& units) {
  std::minstd_rand random(7);
  const auto part = [&] { return 1.2 * random() / std::minstd_rand::max() - 0.1; };
  std::vector<protocol::Particle> grains(40);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    auto& [state, shape] = grains[i];
    shape.id = state.id = static_cast<std::int64_t>(3 * i + 1);
    shape.radius = (1.0 + 3.0 * static_cast<double>(i % 4)) * units.dx;
    for (int k = 0; k < domain.dimension(); ++k)
      state.x[k] = units.origin[k] + units.dx * domain.cells()[k] * part();
    state.v = {static_cast<double>(i), 0.0, 0.0};
  }
  for (const std::size_t sphere : {1U, 2U}) {
    grains[sphere].shape.carrier = grains[0].state.id;
    grains[sphere].shape.radius = units.dx;
    grains[sphere].state.x = grains[0].state.x;
    grains[sphere].state.x[1] += (sphere == 1 ? 3.0 : -3.0) * units.dx;
  }
  grains[0].shape.radius = 4.0 * units.dx;
  return grains;
}

std::vector<protocol::Particle> that_touch(const protocol::Hello& block,
                                           const std::vector<protocol::Particle>& grains) {
  std::vector<protocol::Particle> all;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto& [state, shape] = grains[i < 3 ? 0 : i];
    if (protocol::touches(block, state.x, shape.radius)) all.push_back(grains[i]);
  }
  return all;
}

double part_of_load(std::int64_t id, int rank) {
  return static_cast<double>(id) + 0.25 * (rank + 1);
}

// Each rank gets what its new cells touch, as if the solid knew of them, and the sum of all parts
// of a load reaches the solid.
TEST(Ranks, RelayParticlesToTheBlocksThatHaveMoved) {
  for (const Box& box : boxes()) {
    if (box.lattice == VelocitySet::D3Q27) continue;
    const Units units{0.01, 0.1, 1000.0, 0.01, {-0.3, 0.2, 0.1}};
    const auto grains = grains_in(box.domain, units);
    for (const Cell3& grid : grids(box.domain)) {
      const auto cuts = cuts_of(box.domain, grid);
      const Decomposition agreed(box.domain, MPI_COMM_WORLD, grid, cuts[0]);
      const Decomposition now(box.domain, MPI_COMM_WORLD, grid, cuts[1]);
      protocol::Hello hello = hello_of(box.domain, units);
      ParticleRelay relay(hello, units, agreed);
      set_subdomain(units, box.domain, agreed.cells(), hello);
      const auto from_wire = that_touch(hello, grains);
      EXPECT_EQ(relay.arrive(from_wire).data(), from_wire.data());  // nothing has moved
      relay.move_to(now);
      const auto here = relay.arrive(from_wire);
      set_subdomain(units, box.domain, now.cells(), hello);
      const auto expected = that_touch(hello, grains);
      ASSERT_EQ(here.size(), expected.size());
      std::vector<protocol::Load> parts;
      for (std::size_t i = 0; i < here.size(); ++i) {
        EXPECT_EQ(here[i].state.id, expected[i].state.id);
        EXPECT_EQ(here[i].state.x, expected[i].state.x);
        EXPECT_EQ(here[i].state.v, expected[i].state.v);
        EXPECT_EQ(here[i].shape.carrier, expected[i].shape.carrier);
        const double part = part_of_load(here[i].state.id, now.rank());
        parts.push_back({here[i].state.id, {part, 0.0, -part}, {0.0, 2.0 * part, 0.0}});
      }
      const auto loads = relay.give_back(parts);
      ASSERT_EQ(loads.size(), from_wire.size());
      std::vector<double> sums(4 * grains.size(), 0.0), wanted(sums);
      for (std::size_t i = 0; i < loads.size(); ++i) {
        EXPECT_EQ(loads[i].id, from_wire[i].state.id);
        const auto at = 4 * static_cast<std::size_t>((loads[i].id - 1) / 3);
        sums[at] += loads[i].force[0];
        sums[at + 1] += loads[i].force[2];
        sums[at + 2] += loads[i].torque[1];
      }
      for (const auto& p : expected) {
        const auto at = 4 * static_cast<std::size_t>((p.state.id - 1) / 3);
        const double part = part_of_load(p.state.id, now.rank());
        wanted[at] += part;
        wanted[at + 1] -= part;
        wanted[at + 2] += 2.0 * part;
      }
      now.sum(sums);
      now.sum(wanted);
      EXPECT_EQ(sums, wanted);  // quarters: exact
    }
  }
}

}  // namespace
