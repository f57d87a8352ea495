// SPDX-License-Identifier: GPL-2.0-or-later
/// What fields, points and the largest speed show in covered cells.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "lbm_solver/solver/fluid.h"
#include "tests/support/openings.h"

namespace {

using namespace lbm;

constexpr double kForce = 1e-5;

KernelChoice choice(SolidTerm term, CollisionOperator collision = CollisionOperator::Trt) {
  return {.collision = collision,
          .force = true,
          .solid_term = term,
          .parameters = {.tau = 0.8, .force_x = kForce}};
}

/// What every cell of a box shows.
struct Shown {
  explicit Shown(Fluid& fluid) {
    const Domain& d = fluid.domain();
    for (int z = 0; z < d.nz; ++z)
      for (int y = 0; y < d.ny; ++y) {
        std::vector<double> density(d.nx), velocity[3];
        for (auto& component : velocity) component.assign(d.nx, 0.0);
        fluid.row(y, z, density, {velocity[0], velocity[1], velocity[2]});
        for (int x = 0; x < d.nx; ++x) {
          rho.push_back(density[x]);
          u.emplace_back(velocity[0][x], velocity[1][x], velocity[2][x]);
        }
      }
  }
  std::vector<double> rho;
  std::vector<Vec3> u;
};

/// Calls f(number, x, y, z) for every cell of a box.
void each_cell(const Domain& d, const std::function<void(std::size_t, int, int, int)>& f) {
  std::size_t i = 0;
  for (int z = 0; z < d.nz; ++z)
    for (int y = 0; y < d.ny; ++y)
      for (int x = 0; x < d.nx; ++x) f(i++, x, y, z);
}

struct Box {
  Domain domain;
  VelocitySet lattice;
  Body body;
};
const std::vector<Box> kBoxes{{{37, 30, Side::Periodic, Side::Periodic},
                               VelocitySet::D2Q9,
                               {1, {17.25, 15.5}, 7.3, {0.0, 0.0}, 0.0}},
                              {{18, 16, Side::Periodic, Side::Periodic, 16, Side::Periodic},
                               VelocitySet::D3Q19,
                               {1, {9.25, 8.5, 8.0}, 5.2, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}}};

// A force drives the fluid past a body at rest. Where the body covers a cell whole nothing moves,
// and there is no pressure; outside both are those of the populations.
TEST(ShownFluid, BodyAtRestHasNoVelocityAndNoPressure) {
  for (const Box& box : kBoxes)
    for (const SolidTerm term : choices<SolidTerm>()) {
      KernelChoice kernel = choice(term);
      kernel.lattice = box.lattice;
      Fluid fluid(box.domain, kernel);
      for (int step = 0; step < 100; ++step) {
        fluid.place(std::vector{box.body});
        fluid.step();
      }
      const Shown shown(fluid);
      double inside_raw = 0.0, mean = 0.0, mean_raw = 0.0;
      int whole = 0, outside = 0;
      each_cell(box.domain, [&](std::size_t i, int x, int y, int z) {
        const auto raw = fluid.cell(x, y, z);
        if (fluid.solid_fraction(x, y, z) >= kWhole) {
          ++whole;
          inside_raw = std::max(inside_raw, raw.u.norm());
          EXPECT_LT(shown.u[i].norm(), 1e-12) << term << ' ' << x << ' ' << y << ' ' << z;
          EXPECT_TRUE(std::isnan(shown.rho[i])) << term << ' ' << x << ' ' << y << ' ' << z;
          return;
        }
        ++outside;
        mean += shown.rho[i];
        mean_raw += raw.rho;
        if (fluid.solid_fraction(x, y, z) > 0.0) return;
        EXPECT_LT((shown.u[i] - raw.u).norm(), 1e-15) << term;  // the same sums, in another order
      });
      EXPECT_GT(whole, 100) << term;
      EXPECT_GT(inside_raw, 1e-9) << term;  // what the populations alone would show
      EXPECT_NEAR(mean / outside, mean_raw / outside, 1e-13) << term;
    }
}

TEST(ShownFluid, MovingBodyHasItsOwnVelocity) {
  for (const Box& box : kBoxes)
    for (const SolidTerm term : choices<SolidTerm>()) {
      KernelChoice kernel = choice(term);
      kernel.lattice = box.lattice;
      Fluid fluid(box.domain, kernel);
      Body body = box.body;
      body.velocity = {0.0078125, -0.0078125, 0.0};  // 1/128: its place is mapped exactly
      body.spin = 0.001;
      for (int step = 0; step < 60; ++step) {
        if (step > 0) body.centre += body.velocity;
        fluid.place(std::vector{body});
        fluid.step();
      }
      const Shown shown(fluid);
      each_cell(box.domain, [&](std::size_t i, int x, int y, int z) {
        if (fluid.solid_fraction(x, y, z) < kWhole) return;
        const Vec3 centre(x + 0.5, y + 0.5, box.domain.dimension() == 3 ? z + 0.5 : 0.0);
        const Vec3 exact = body.velocity_at(box.domain.nearest_image(centre - body.centre));
        EXPECT_LT((shown.u[i] - exact).norm(), 1e-12) << term << ' ' << x << ' ' << y << ' ' << z;
        EXPECT_TRUE(std::isnan(shown.rho[i])) << term;
      });
    }
}

// (1-B) u + B u_s with the weight of the collision, or half of what a collision by resistance
// takes: of the momentum against the solid's and of the ghost.
TEST(ShownFluid, PartlyCoveredCellsMixBothVelocities) {
  const Box& box = kBoxes[0];
  for (const SolidTerm term : {SolidTerm::NobleTorczynski, SolidTerm::Resistance}) {
    Fluid fluid(box.domain, choice(term));
    Body body = box.body;
    body.velocity = {0.02, 0.01};
    for (int step = 0; step < 20; ++step) {
      fluid.place(std::vector{body});
      fluid.step();
    }
    const Shown shown(fluid);
    int mixed = 0;
    each_cell(box.domain, [&](std::size_t i, int x, int y, int) {
      const double eps = fluid.cover()->cell(x, y).cover, s = 0.8 - 0.5;
      if (eps <= 0.0 || eps >= kWhole) return;
      ++mixed;
      const Fluid::Cell raw = fluid.cell(x, y);
      double share = eps * s / ((1.0 - eps) + s);
      Vec3 ghost = Vec3::Zero();
      if (term == SolidTerm::Resistance) {
        // Λ = 3/16: μ(0) = 2 - 16 Λ/3 = 1
        const auto taken = surface_exchange<D2Q9, Pack>(Pack(eps), Pack(s), Pack(1.0));
        share = 0.5 * taken.momentum[0];
        const Lattice& lattice = fluid.lattice();
        for (int q = 1; q < lattice.Q; ++q) {  // z = Σ c_i ψ_i f_i, in two dimensions r² = 2
          const int* c = lattice.c[q];
          const double psi = c[0] * c[1] == 0 ? 1.0 / std::sqrt(2.0) : -std::sqrt(2.0);
          ghost += psi * fluid.arriving(q, x, y) * Vec3(c[0], c[1], 0.0);
        }
        ghost *= 0.5 * taken.cross[0] / raw.rho;
      }
      const Vec3 exact = (1.0 - share) * raw.u + share * body.velocity - ghost;
      EXPECT_LT((shown.u[i] - exact).norm(), 1e-15) << term << ' ' << eps;
      EXPECT_TRUE(std::isfinite(shown.rho[i]));
    });
    EXPECT_GT(mixed, 20);
  }
}

TEST(ShownFluid, WallsRest) {
  const Domain domain{20, 12, Side::Periodic, Side::Periodic};
  Fluid fluid(domain, choice(SolidTerm::LayeredHoldych));
  fluid.add_wall({5, 0, 0}, {8, 6, 1});
  fluid.advance(100);
  const Shown shown(fluid);
  each_cell(domain, [&](std::size_t i, int x, int y, int) {
    const bool wall = x >= 5 && x < 8 && y < 6;
    EXPECT_EQ(std::isnan(shown.rho[i]), wall);
    EXPECT_TRUE(!wall || shown.u[i].norm() == 0.0);
  });
}

// Walls beside an opening that draws fluid away, and a grain in the way: what their whole cells
// hold is bounded by what the fluid brings to them. (Walls that take the row of Noble and
// Torczynski pump mass from one side to the other for ever: four times the largest change of
// density outside after 8000 steps.)
TEST(ShownFluid, DensityInSolidsDoesNotDrift) {
  for (const SolidTerm term :
       {SolidTerm::LayeredNobleTorczynski, SolidTerm::LayeredHoldych, SolidTerm::NobleTorczynski})
    for (const auto collision : {CollisionOperator::CentralMoment, CollisionOperator::Trt}) {
      const Domain domain{40, 40};
      const double tau = collision == CollisionOperator::Trt ? 0.6 : 0.50003;
      Fluid fluid(domain, {.collision = collision,
                           .solid_term = term,
                           .parameters = {.tau = tau, .smagorinsky = 0.1}});
      const Opening bottom = Opening::whole(domain, SideName::Bottom);
      test::add_pressure(fluid, bottom, 0.0);
      test::add_pressure(fluid, test::part(SideName::Top, 14, 26), -0.009, {1000.0, 0.0});
      fluid.add_wall({10, 20, 0}, {14, 40, 1});
      fluid.add_wall({26, 20, 0}, {30, 40, 1});
      const std::vector<Body> grain{{1, {20.3, 12.1}, 5.0, {0.0, 0.0}, 0.0}};
      fluid.place(grain);
      double drift = 0.0;
      for (int k = 0; k < 8; ++k) {
        fluid.advance(1000);
        double inside = 0.0, outside = 0.0;
        each_cell(domain, [&](std::size_t, int x, int y, int) {
          double& largest = fluid.solid_fraction(x, y) >= kWhole ? inside : outside;
          largest = std::max(largest, std::abs(fluid.cell(x, y).rho - 1.0));
        });
        ASSERT_GT(outside, 0.002);
        drift = std::max(drift, inside / outside);
      }
      EXPECT_LT(drift, 1.0) << term << ' ' << collision;
    }
}

// In steady flow as much enters a cell as leaves it, and over the box bodies take what the force
// gives: the flux is the mean of what arrives, without half of the force. In this array of packed
// bodies that half is a seventh of it. All faces of the box see the same flux.
TEST(ShownFluid, MeanVelocityIsTheFluxByResistance) {
  const std::vector<Box> arrays{{{12, 12, Side::Periodic, Side::Periodic},
                                 VelocitySet::D2Q9,
                                 {1, {6.13, 6.23}, 4.8, Vec3(), Spin()}},
                                {{12, 12, Side::Periodic, Side::Periodic, 12, Side::Periodic},
                                 VelocitySet::D3Q19,
                                 {1, {6.13, 6.23, 6.41}, 5.2, Vec3(), Spin()}}};
  for (const Box& box : arrays) {
    KernelChoice kernel = choice(SolidTerm::Resistance);
    kernel.lattice = box.lattice;
    kernel.parameters.tau = 1.5;
    kernel.parameters.magic = kResistanceMagic;
    Fluid fluid(box.domain, kernel);
    fluid.place(std::vector{box.body});
    fluid.advance(4000);
    const Shown shown(fluid);
    double sum = 0.0, arrived = 0.0;
    each_cell(box.domain, [&](std::size_t i, int x, int y, int z) {
      const Fluid::Cell raw = fluid.cell(x, y, z);
      arrived += fluid.arrived_momentum(x, y, z).x();
      EXPECT_NEAR(fluid.arrived_momentum(x, y, z).x(), raw.rho * raw.u.x() - 0.5 * kForce, 1e-15);
      sum += raw.rho * shown.u[i].x();
    });
    EXPECT_GT(0.5 * kForce * static_cast<double>(shown.u.size()), 0.02 * arrived) << box.lattice;
    EXPECT_NEAR(sum / arrived, 1.0, 1e-6) << box.lattice;
  }
}

TEST(ShownFluid, SchemesOfTheirOwnShowTheBodyWhereItCoversCellsWhole) {
  const Box& box = kBoxes[0];
  for (const SolidScheme scheme :
       {SolidScheme::BounceBack, SolidScheme::ImplicitImmersedBoundary}) {
    Fluid fluid(box.domain, choice(SolidTerm::None));
    fluid.use(make_scheme(scheme, box.domain, fluid.lattice()));
    Body body = box.body;
    body.velocity = {0.001, 0.0};
    for (int step = 0; step < 20; ++step) {
      fluid.place(std::vector{body});
      fluid.step();
    }
    const Shown shown(fluid);
    each_cell(box.domain, [&](std::size_t i, int x, int y, int) {
      const bool whole = fluid.solid_fraction(x, y) >= kWhole;
      EXPECT_EQ(std::isnan(shown.rho[i]), whole) << scheme;
      EXPECT_TRUE(!whole || (shown.u[i] - body.velocity).norm() < 1e-15) << scheme;
    });
  }
}

// A point shows the density of the cells around it that have fluid.
TEST(ShownFluid, PointsAtASurfaceAndInABody) {
  const Domain domain{20, 12, Side::Periodic, Side::Periodic};
  Fluid fluid(domain, choice(SolidTerm::Holdych));
  fluid.add_wall({8, 0, 0}, {12, 12, 1});
  each_cell(domain, [&](std::size_t, int x, int y, int) {
    fluid.set_equilibrium(x, y, x < 8 || x >= 12 ? 1.01 : 1.5, {0.02, 0.0});
  });
  const auto inside = fluid.at({10.0, 6.0, 0.0});
  EXPECT_TRUE(std::isnan(inside.rho));
  EXPECT_EQ(inside.u.norm(), 0.0);
  const auto outside = fluid.at({4.3, 6.2, 0.0});
  EXPECT_NEAR(outside.rho, 1.01, 1e-14);
  EXPECT_NEAR(outside.u.x(), 0.02, 1e-14);
  const auto surface = fluid.at({8.0, 6.2, 0.0});  // between a fluid cell and one of the wall
  EXPECT_NEAR(surface.rho, 1.01, 1e-14);
  EXPECT_NEAR(surface.u.x(), 0.01, 1e-14);
}

// Cells without fluid do not count as fast; what is not finite is found everywhere.
TEST(ShownFluid, LargestSpeedIsThatOfTheFluid) {
  const Box& box = kBoxes[0];
  Fluid fluid(box.domain, choice(SolidTerm::Holdych));
  fluid.place(std::vector{box.body});
  fluid.set_equilibrium(3, 4, 1.0, {0.05, 0.0});
  fluid.set_equilibrium(17, 15, 1.0, {0.3, 0.0});  // in the body
  auto e = fluid.extremes();
  EXPECT_NEAR(e.max_speed, 0.05, 1e-12);
  EXPECT_EQ(e.cell, (Cell3{3, 4, 0}));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    fluid.arriving(3, 17, 15) = bad;
    e = fluid.extremes();
    EXPECT_FALSE(e.finite);
    EXPECT_EQ(e.cell, (Cell3{17, 15, 0}));
  }
}

}  // namespace
