// SPDX-License-Identifier: GPL-2.0-or-later
/// Every row of the kernel table, on every combination of sides and on odd sizes, against the naive
/// reference from a random state.
#include <gtest/gtest.h>
#include <omp.h>

#include <random>

#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "tests/reference/naive_lattice.h"

namespace {

using namespace lbm;

constexpr double kTau = 0.65, kMagic = 3.0 / 16.0;

/// One inside, one across the sides' corner (an image each where periodic), one overlapping the
/// first.
std::vector<Body> three_bodies(const Domain& d) {
  const Vec3 middle(0.55 * d.nx, 0.5 * d.ny, d.dimension() == 3 ? 0.5 * d.nz : 0.0);
  const double small = d.dimension() == 3 ? 0.6 : 1.0;  // boxes are smaller there
  std::vector<Body> bodies{
      {1, middle, 4.3 * small, {0.02, -0.01, 0.01}, {0.001, -0.002, 0.003}},
      {2, {0.4, 0.7, 0.3}, 2.6 * small, {-0.01, 0.02, 0.01}, {0.002, 0.001, -0.002}},
      {3, middle + small * Vec3(6.1, 1.2, -0.7), 2.2 * small, {0.0, 0.01, 0.0}, Vec3()}};
  if (d.dimension() == 2)
    for (Body& b : bodies) {
      b.centre.z() = b.velocity.z() = 0.0;
      b.spin = b.spin.z();
    }
  return bodies;
}

template <class F>
void each_cell(const Domain& d, F&& f) {
  for (int z = 0; z < d.nz; ++z)
    for (int y = 0; y < d.ny; ++y)
      for (int x = 0; x < d.nx; ++x) f(x, y, z);
}

/// The same random state in both, near a moving fluid but far from equilibrium.
void randomise(Fluid& fluid, test::NaiveLattice& naive) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> noise(-1.0, 1.0);
  const Lattice& l = fluid.lattice();
  each_cell(fluid.domain(), [&](int x, int y, int z) {
    Vec3 u(0.05 * noise(random), 0.05 * noise(random), 0.05 * noise(random));
    if (l.D == 2) u.z() = 0.0;
    const auto eq = naive.equilibrium(1.0 + 0.01 * noise(random), u);
    for (int q = 0; q < l.Q; ++q) {
      fluid.arriving(q, x, y, z) = eq[q] * (1.0 + 0.02 * noise(random)) - l.w[q];
      naive.cell(x, y, z)[q] = fluid.arriving(q, x, y, z) + l.w[q];
    }
  });
}

/// Copies the cover map cell by cell, so that only the sweep is under test.
void copy_cover(const CoverMap& cover, const Domain& d, test::NaiveLattice& naive) {
  each_cell(d, [&](int x, int y, int z) {
    const CoverMap::Cell cell = cover.cell(x, y, z);
    const double eps = cover.solid_fraction(x, y, z);
    naive.cover(x, y, z) = {eps, eps >= 1.0 - 1e-12, cell.cover == kCore, cell.cover == kWall,
                            cell.velocity};
  });
}

/// Those of the step just made, and of the next ones.
void copy_eddies(const Fluid& fluid, test::NaiveLattice& naive) {
  if (!fluid.eddies()) return;
  each_cell(fluid.domain(),
            [&](int x, int y, int z) { naive.eddies(x, y, z) = fluid.eddies()->row(y, z)[x]; });
}

double largest_difference(Fluid& fluid, test::NaiveLattice& naive) {
  double largest = 0.0;
  const Lattice& l = fluid.lattice();
  each_cell(fluid.domain(), [&](int x, int y, int z) {
    for (int q = 0; q < l.Q; ++q)
      largest =
          std::max(largest, std::abs(fluid.arriving(q, x, y, z) + l.w[q] - naive.cell(x, y, z)[q]));
  });
  return largest;
}

/// A block at rest in the middle of the box, beside and below the first bodies.
void add_block(Fluid& fluid) {
  const Domain& d = fluid.domain();
  const bool flat = d.dimension() == 2;
  fluid.add_wall({d.nx / 4, d.ny / 2, flat ? 0 : d.nz / 3},
                 {d.nx / 2 + 1, d.ny / 2 + 3, flat ? 1 : d.nz / 2 + 1});
}

/// Of what the solids of a SIMD block bear together: force, and its moment about the first cell.
double largest_force_difference(const CoverMap& cover, const Domain& d, test::NaiveLattice& naive) {
  double largest = 0.0;
  for (int z = 0; z < d.nz; ++z)
    for (int y = 0; y < d.ny; ++y)
      for (int b = 0; b < cover.blocks_per_row(); ++b) {
        Vec3 difference, moment_difference;
        for (const CoverBlock* block = cover.row(y, z)[b]; block; block = block->next) {
          difference += block->force();
          moment_difference += block->moment();
        }
        for (int lane = 0; lane < kPackWidth && b * kPackWidth + lane < d.nx; ++lane) {
          Vec3 force = naive.force(b * kPackWidth + lane, y, z);
          difference -= force;
          force.x() = 0.0;
          moment_difference -= lane * force;
        }
        largest = std::max(
            {largest, difference.cwiseAbs().maxCoeff(), moment_difference.cwiseAbs().maxCoeff()});
      }
  return largest;
}

/// A viscosity that falls with the shear rate, whose range the random states cross.
std::shared_ptr<const RelaxationTable> thinning(double times) {
  return std::make_shared<RelaxationTable>([times](double shear_rate) {
    return 0.5 + 3.0 * times * std::clamp(0.006 / std::sqrt(shear_rate), 0.03, 0.08);
  });
}

/// Rows of a lattice. In three dimensions, and in single precision, terms that share a
/// collision with others are left out.
std::vector<KernelChoice> rows_of(VelocitySet lattice, Precision precision) {
  std::vector<KernelChoice> rows;
  struct Solids {
    SolidTerm term;
    WeightRule weight = WeightRule::Viscous;
  };
  std::vector<Solids> all_solids{
      {SolidTerm::None}, {SolidTerm::LayeredHoldych}, {SolidTerm::LayeredResistance}};
  if (lattice == VelocitySet::D2Q9 && precision == Precision::Double) {
    all_solids = {{SolidTerm::None},
                  {SolidTerm::NobleTorczynski, WeightRule::Fraction},
                  {SolidTerm::Holdych, WeightRule::Balanced}};
    for (const SolidTerm term : choices<SolidTerm>()) all_solids.push_back({term});
  }
  for (const CollisionOperator collision : choices<CollisionOperator>()) {
    if (collision == CollisionOperator::RecursiveRegularised && precision == Precision::Single)
      continue;
    for (const double smagorinsky : {0.0, 0.17})
      for (const bool force : {false, true})
        for (const auto& [term, weight] : all_solids) {
          if (collision != CollisionOperator::Trt && by_resistance(term)) continue;
          rows.push_back({.collision = collision,
                          .force = force,
                          .solid_term = term,
                          .parameters = {.tau = kTau,
                                         .magic = kMagic,
                                         .smagorinsky = smagorinsky,
                                         .force_x = 2e-4,
                                         .force_y = -1e-4,
                                         .force_z = lattice == VelocitySet::D2Q9 ? 0.0 : 3e-4},
                          .weight = weight,
                          .lattice = lattice,
                          .precision = precision});
          if (smagorinsky > 0.0 && !force) continue;
          rows.push_back(rows.back());
          if (smagorinsky > 0.0) {
            rows.back().eddies = EddyModel::Wale;
            continue;
          }
          static const auto law = thinning(1.0), covered = thinning(1.2);
          rows.back().parameters.viscosity_table = law;
          rows.back().parameters.covered_table = covered;
        }
  }
  return rows;
}

std::vector<KernelChoice> all_rows() {
  std::vector<KernelChoice> rows;
  for (const VelocitySet lattice : choices<VelocitySet>())
    for (const Precision precision : {Precision::Double, Precision::Single}) {
      const auto part = rows_of(lattice, precision);
      rows.insert(rows.end(), part.begin(), part.end());
    }
#ifdef BPLBM_TWO_ROWS  // what tests/sanitized compiles
  std::erase_if(rows, [](const KernelChoice& c) {
    return c.collision != CollisionOperator::Trt || c.precision != Precision::Double || c.force ||
           c.local_viscosity() ||
           (c.lattice != VelocitySet::D2Q9 && c.lattice != VelocitySet::D3Q19);
  });
#endif
  return rows;
}

std::vector<Domain> domains_of(const KernelChoice& c) {
  std::vector<Domain> all;
  const Side sides[] = {Side::Periodic, Side::Wall};
  for (const Side x : sides)
    for (const Side y : sides) {
      if (c.lattice == VelocitySet::D2Q9) {
        for (const auto& [nx, ny] : {std::pair{37, 21}, {32, 17}, {19, 24}})
          all.push_back({nx, ny, x, y});
        continue;
      }
      for (const Side z : sides) all.push_back({19, 8, x, y, 7, z});
    }
  return all;
}

std::string name_of(const KernelChoice& c) {
  return name_of(c.lattice) + (c.precision == Precision::Single ? "_single_" : "_") +
         name_of(c.collision) + (c.parameters.smagorinsky == 0.0 ? "" : "_les") +
         (c.eddies == EddyModel::Wale ? "_wale" : "") +
         (c.parameters.viscosity_table ? "_thinning" : "") + (c.force ? "_force" : "") + "_" +
         name_of(c.solid_term) +
         (c.weight == WeightRule::Fraction   ? "_fraction"
          : c.weight == WeightRule::Balanced ? "_balanced"
                                             : "");
}

class KernelTest : public testing::TestWithParam<KernelChoice> {};

TEST_P(KernelTest, EqualsTheNaiveReference) {
  const KernelChoice& choice = GetParam();
  const bool solids = choice.solid_term != SolidTerm::None,
             flat = choice.lattice == VelocitySet::D2Q9;
  // Round-off of some steps with sums of up to 27 terms of order one, and of a linear system of as
  // many unknowns in the reference: a few 1e-16 each. Floats: of the deviations, which are 0.05.
  const bool single = choice.precision == Precision::Single;
  const double limit = single ? 3e-7 : flat ? 2e-14 : 6e-14;
  for (const Domain& domain : domains_of(choice)) {
    Fluid fluid(domain, choice);
    test::NaiveLattice naive(domain, choice);
    if (solids) add_block(fluid);
    randomise(fluid, naive);
    ASSERT_EQ(largest_difference(fluid, naive), 0.0) << "initial state";
    auto bodies = three_bodies(domain);
    for (int step = 0; step < (flat ? 7 : 4); ++step) {
      if (solids) {
        fluid.place(bodies);
        copy_cover(*fluid.cover(), domain, naive);
      }
      fluid.step();
      copy_eddies(fluid, naive);
      naive.step();
      EXPECT_LT(largest_difference(fluid, naive), limit)
          << domain.nx << 'x' << domain.ny << 'x' << domain.nz << " step " << step;
      if (solids) {
        // A moment adds up to eight cells' forces, each times a lane number up to seven, and a wall
        // turns all of a cell's momentum: in floats, four times a population's limit.
        EXPECT_LT(largest_force_difference(*fluid.cover(), domain, naive),
                  single ? 4.0 * limit : limit);
      }
      for (Body& b : bodies) b.centre += b.velocity;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, KernelTest, testing::ValuesIn(all_rows()),
                         [](const auto& info) { return name_of(info.param); });

TEST(KernelTable, RefusesResistanceWithAnotherOperatorThanTrt) {
  try {
    make_kernel(
        {.collision = CollisionOperator::CentralMoment, .solid_term = SolidTerm::Resistance});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("needs the collision trt"), std::string::npos) << e.what();
  }
}

TEST(KernelTable, NamesItsRowsWhereOneIsMissing) {
  try {
    make_kernel(
        {.collision = CollisionOperator::RecursiveRegularised, .precision = Precision::Single});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("D2Q9 double trt + constant viscosity + no force"),
              std::string::npos)
        << e.what();
  }
}

TEST(Fluid, SameBitsStepByStepAndTogether) {
  omp_set_num_threads(2);
  for (const bool lid : {false, true}) {  // with a pass between the sweeps, or without
    const Domain domain{21, 14, Side::Periodic, Side::Wall};
    const KernelChoice choice{.parameters = {.tau = kTau, .magic = kMagic}};
    Fluid one(domain, choice), together(domain, choice);
    test::NaiveLattice unused(domain, choice);
    for (Fluid* fluid : {&one, &together}) {
      randomise(*fluid, unused);
      if (lid) {
        const Opening top = Opening::whole(domain, SideName::Top);
        fluid->add(std::make_unique<VelocityPatch>(fluid->lattice(), fluid->links(top),
                                                   Vec3(0.01, 0.0), false, top, InTime{0.0, 30.0}));
      }
    }
    for (int step = 0; step < 17; ++step) one.step();
    together.advance(6);
    together.advance(11);
    EXPECT_TRUE(one.save() == together.save()) << lid;
  }
  omp_set_num_threads(1);
}

TEST(Kernel, SameBitsWithAnyNumberOfThreads) {
  const Domain domain{45, 33, Side::Periodic, Side::Wall};
  std::vector<std::vector<double>> states;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    const KernelChoice choice{.solid_term = SolidTerm::LayeredHoldych,
                              .parameters = {.tau = kTau, .magic = kMagic}};
    Fluid fluid(domain, choice);
    test::NaiveLattice unused(domain, choice);
    randomise(fluid, unused);
    std::vector<double> all;
    for (int step = 0; step < 20; ++step) {
      fluid.place(three_bodies(domain));
      fluid.step();
      for (const auto& l : fluid.loads())
        all.insert(all.end(), {l.force.x(), l.force.y(), l.torque.z()});
    }
    for (int y = 0; y < domain.ny; ++y)
      for (int x = 0; x < domain.nx; ++x) all.push_back(fluid.arriving(5, x, y));
    states.push_back(all);
  }
  omp_set_num_threads(1);
  EXPECT_EQ(states[1], states[0]);
  EXPECT_EQ(states[2], states[0]);
}

}  // namespace
