// SPDX-License-Identifier: GPL-2.0-or-later
/// A box shared by several ranks against the same box on one: started as `mpirun -np N ranks`,
/// where every rank also sweeps the whole box by itself and compares its own cells: bit for bit
/// where rows are whole. Where x is cut, a covered cell of a float box is swept with other cells
/// beside it: then to round-off of what is stored.
#include <omp.h>

#include "lbm_solver/coupling/lubrication.h"
#include "tests/ranks/on_ranks.h"

namespace {

using namespace test;

/// A box with all that it may hold, in a state that is the same on any blocks.
Fluid random_fluid(const Box& box, const Decomposition& ranks, const KernelChoice& choice) {
  Fluid fluid(ranks, choice);
  add_patches(fluid);
  fluid.add_wall({3, 0, 0}, {9, 4, box.domain.nz});
  randomise(fluid);
  return fluid;
}

/// A few steps among bodies that move; returns their loads in each, of this rank's cells.
std::vector<std::vector<double>> loads_of_steps(Fluid& fluid) {
  std::vector<Body> bodies = bodies_in(fluid.domain());
  std::vector<std::vector<double>> loads;
  for (int step = 0; step < 5; ++step) {
    fluid.place(bodies);
    fluid.step();
    loads.push_back(numbers(fluid.loads()));
    for (Body& b : bodies) b.centre += b.velocity;
  }
  return loads;
}

void expect_sweeps_alike(const Box& box, Precision precision) {
  const KernelChoice choice = choice_for(box.lattice, precision);
  Fluid whole = random_fluid(box, Decomposition(box.domain), choice);
  const auto loads_of_whole = loads_of_steps(whole);
  for (const Cell3& grid : grids(box.domain))
    for (const bool uneven : {false, true}) {
      if (uneven && precision == Precision::Single) continue;
      SCOPED_TRACE(testing::Message()
                   << box.lattice << ' ' << grid[0] << grid[1] << grid[2] << ", " << uneven);
      const Decomposition ranks(box.domain, MPI_COMM_WORLD, grid,
                                cuts_of(box.domain, grid)[uneven]);
      const Limits limit = limits(precision, grid);
      Fluid part = random_fluid(box, ranks, choice);
      auto loads = loads_of_steps(part);
      for (std::size_t step = 0; step < loads.size(); ++step) {
        ranks.sum(loads[step]);
        expect_near(loads[step], loads_of_whole[step], limit.load);
      }
      expect_same_cells(part, whole, limit.population);
      const auto a = part.extremes(), b = whole.extremes();
      const double of_sums = 1e-12 + 1e4 * limit.population;
      EXPECT_NEAR(a.max_speed, b.max_speed, 30.0 * limit.population);
      EXPECT_EQ(a.cell, b.cell);
      EXPECT_NEAR(a.mass_excess, b.mass_excess, of_sums);
      EXPECT_NEAR(part.mass_in(), whole.mass_in(), of_sums);
      const Vec3 place(0.5 * box.domain.nx, 0.5 * box.domain.ny, 0.5 * box.domain.nz);
      EXPECT_NEAR(part.at(place).u.x(), whole.at(place).u.x(), 1e-15 + 30.0 * limit.population);
    }
}

TEST(Ranks, SweepTheSameCellsAsOneAlone) {
  for (const Box& box : boxes())
    for (const Precision precision : {Precision::Double, Precision::Single})
      expect_sweeps_alike(box, precision);
}

/// What walls that move do does not depend on the ranks: cells, and loads to 1e-12 of the largest.
TEST(Ranks, MoveTheSameWallsAsOneAlone) {
  const Side p = Side::Periodic, w = Side::Wall;
  for (const Box& box :
       {Box{VelocitySet::D2Q9, {29, 23, p, w}}, Box{VelocitySet::D3Q19, {23, 14, p, w, 13, p}}})
    for (const Cell3& grid : grids(box.domain)) {
      SCOPED_TRACE(testing::Message() << box.lattice << ' ' << grid[0] << grid[1] << grid[2]);
      const Decomposition ranks(box.domain, MPI_COMM_WORLD, grid);
      const KernelChoice choice = choice_for(box.lattice, Precision::Double);
      Fluid part(ranks, choice), whole(box.domain, choice);
      std::vector<Body> bodies = bodies_in(box.domain);
      for (Fluid* f : {&part, &whole}) {
        add_movers(*f);
        f->place(bodies);
        randomise(*f);
      }
      double largest = 0.0;
      std::vector<double> sums, alone;
      for (int step = 0; step < 15; ++step) {
        part.step();
        whole.step();
        sums = numbers(part.fixed_loads());
        alone = numbers(whole.fixed_loads());
        ranks.sum(sums);
        for (const double load : alone) largest = std::max(largest, std::abs(load));
        expect_near(sums, alone, 1e-12 * largest);
      }
      EXPECT_GT(largest, 1e-3);
      expect_same_cells(part, whole, grid[0] == 1 ? 0.0 : 1e-15);
    }
}

// The mean velocity is added up in whole numbers, so that every grid finds the same force.
TEST(Ranks, HoldTheSameFlow) {
  const Domain domain{23, 14, Side::Wall, Side::Periodic, 13, Side::Wall};
  KernelChoice choice = choice_for(VelocitySet::D3Q19, Precision::Double);
  choice.force = true;
  for (const Cell3& grid : grids(domain)) {
    const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
    Fluid part(ranks, choice), whole(domain, choice);
    for (Fluid* f : {&part, &whole}) {
      f->place(bodies_in(domain));
      f->hold_flow({1, 0.01, {}, domain.ny});
      randomise(*f);
      f->advance(40);
    }
    EXPECT_NEAR(part.flow_control()->force(), whole.flow_control()->force(), 1e-15);
    expect_same_cells(part, whole, 1e-15);
  }
}

// The eddy viscosity looks one cell beyond each face, and is found from the same velocities on
// every grid; the pressure on an opening from the mass through it, added up in another order.
TEST(Ranks, HaveTheSameEddiesAndTheSameHeldPressure) {
  const Domain domain{23, 14, Side::Wall, Side::Periodic, 13, Side::Wall};
  KernelChoice choice = choice_for(VelocitySet::D3Q19, Precision::Double);
  choice.collision = CollisionOperator::CentralMoment;
  choice.solid_term = SolidTerm::LayeredNobleTorczynski;
  choice.parameters.smagorinsky = 0.2;
  choice.eddies = EddyModel::Wale;
  for (const Cell3& grid : grids(domain)) {
    const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
    Fluid part(ranks, choice), whole(domain, choice);
    for (Fluid* f : {&part, &whole}) {
      f->place(bodies_in(domain));
      for (const SideName side : {SideName::Left, SideName::Right})
        f->add(std::make_unique<PressurePatch>(f->links(Opening::whole(domain, side)), side, 0.0,
                                               InTime{}));
      f->hold_flow(PressureControl(0, 0.01 * 14 * 13, {}, 14 * 13, 23, 0.0));
      randomise(*f);
      f->advance(21);
    }
    EXPECT_NEAR(part.pressure_control()->drho(), whole.pressure_control()->drho(), 1e-13);
    expect_same_cells(part, whole, 1e-12);
  }
}

TEST(Ranks, AddEachLubricationForceOnce) {
  for (const Side side : {Side::Periodic, Side::Wall}) {
    const Domain domain{24, 20, side, side, 16, side};
    std::vector<Body> bodies;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(0.0, 1.0), speed(-0.01, 0.01);
    for (int i = 0; i < 60; ++i)
      bodies.push_back({i,
                        {24.0 * at(random), 20.0 * at(random), 16.0 * at(random)},
                        1.5,
                        {speed(random), speed(random), speed(random)}});
    const std::vector<double> masses(bodies.size(), 20.0);
    const Lubrication lubrication{0.1, 1.0, 1.0};
    std::vector<BodyLoad> whole(bodies.size());
    lubrication.add(bodies, masses, domain, whole);
    for (const Cell3& grid : grids(domain)) {
      const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
      std::vector<BodyLoad> part(bodies.size());
      lubrication.add(bodies, masses, domain, ranks.cells(), part);
      std::vector<double> sums = numbers(part);
      ranks.sum(sums);
      expect_near(sums, numbers(whole), 1e-14);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  testing::InitGoogleTest(&argc, argv);
  omp_set_num_threads(world_size() <= 2 ? 2 : 1);
  int failed = RUN_ALL_TESTS();
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
