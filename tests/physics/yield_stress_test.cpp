// SPDX-License-Identifier: GPL-2.0-or-later
/// Fluids with a yield stress beside bodies: what a covered cell knows of its stress, torque and
/// load where all shear is in a layer at the surface.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/viscosity/local_viscosity.h"
#include "tests/support/gels.h"

namespace {

using namespace lbm;
using std::numbers::pi;
using test::Gel, test::parameters, test::parameters_beside;

/// A cylinder that turns in a hollow one.
struct Cylinders {
  double inner, outer;
  int size = 2 * static_cast<int>(std::ceil(outer)) + 6;
  Vec3 centre = Vec3(0.5 * size + 0.137, 0.5 * size - 0.211);
  std::vector<Body> bodies(double spin) const {
    return {{1, centre, inner, Vec3(), Spin(spin)}, {2, centre, outer, Vec3(), Spin(), true}};
  }
};

/// √(2 Q_ab Q_ab) of the fluid of a cell of which a part t is open.
double stress_of(const Fluid& fluid, int x, int y, double t) {
  const Lattice& l = fluid.lattice();
  const auto [rho, u] = fluid.cell(x, y);
  double xx = -rho * (u.x() * u.x() - u.y() * u.y()), xy = -rho * u.x() * u.y();
  for (int i = 1; i < l.Q; ++i) {
    const double f = fluid.arriving(i, x, y);
    xx += f * (l.c[i][0] * l.c[i][0] - l.c[i][1] * l.c[i][1]);
    xy += f * l.c[i][0] * l.c[i][1];
  }  // without the trace, ½ xx on either axis
  return std::sqrt(LocalViscosity::fluid_squares(0.5 * xx * xx, xy * xy, 0.0, 0.0, t));
}

// What a covered cell takes for the stress of its fluid, in a Newtonian fluid beside a cylinder of
// 50 cells: over all directions, by the part t of the cell that is fluid. Curvature makes it r⁻² of
// the middle of the fluid, up to 4 %; the rest is how directions differ.
TEST(CoveredCell, KnowsTheStressOfItsFluid) {
  constexpr double tau = 1.0, spin = 2e-4;
  const Cylinders c{50.0, 62.0};
  CollisionParameters p{.tau = tau, .magic = kResistanceMagic};
  p.viscosity_table = std::make_shared<RelaxationTable>([](double) { return tau; });
  Fluid fluid({c.size, c.size}, {.solid_term = SolidTerm::LayeredResistance, .parameters = p});
  fluid.place(c.bodies(spin));
  fluid.advance(5000);
  const double r2 = c.inner * c.inner, big2 = c.outer * c.outer;
  const double shear_rate = 2.0 * spin * big2 / (big2 - r2);  // at the inner surface
  double sums[10] = {}, cells[10] = {};
  for (int y = 0; y < c.size; ++y)
    for (int x = 0; x < c.size; ++x) {
      const double t = 1.0 - fluid.solid_fraction(x, y);
      const double r = std::hypot(x + 0.5 - c.centre.x(), y + 0.5 - c.centre.y());
      if (r > c.inner + 3.0 || t >= 1.0 || t < 0.1) continue;
      const int k = static_cast<int>(10.0 * t);
      sums[k] += stress_of(fluid, x, y, t) / (2.0 / 3.0 * tau * shear_rate);
      cells[k] += 1.0;
    }
  for (int k = 1; k < 10; ++k) {
    EXPECT_NEAR(sums[k] / cells[k], 1.0, 0.05) << "t = " << 0.1 * k;
    RecordProperty("t" + std::to_string(k), std::to_string(sums[k] / cells[k]));
  }
}

/// Torque of a cylinder in a Bingham fluid over the exact one: σ = s R²/r² with s at the surface,
///   ω = ∫ γ̇/r dr = (½ s (1 - R²/r_y²) - σ_y ln(r_y/R))/K,   r_y = R √(s/σ_y) or the outer radius.
double bingham_torque(double inner, double bingham) {
  constexpr double tau = 3.0, nu = (tau - 0.5) / 3.0, speed = 1e-3;
  const Cylinders c{inner, 2.0 * inner};
  const double rate = speed / inner, part = bingham / (1.0 + bingham);
  const Gel gel{.yield_part = part, .span = 30.0, .thinnest = 1e-4};
  Fluid fluid({c.size, c.size},
              {.solid_term = SolidTerm::LayeredResistance,
               .parameters = parameters_beside(inner, 2, gel.law(tau, rate), tau)});
  fluid.place(c.bodies(rate));
  const double yield = part * nu * rate, plastic = (1.0 - part) * nu;
  double low = yield, high = 100.0 * yield;
  for (int k = 0; k < 100; ++k) {
    const double s = 0.5 * (low + high), end2 = std::min(4.0, s / yield);  // (r_y/R)²
    const double spin = (0.5 * s * (1.0 - 1.0 / end2) - 0.5 * yield * std::log(end2)) / plastic;
    (spin < rate ? low : high) = s;
  }
  double torque = 0.0;
  fluid.advance(3000);
  for (int look = 0; look < 10; ++look) {
    fluid.advance(50);
    torque -= 0.1 * fluid.loads()[0].torque.z();
  }
  return torque / (2.0 * pi * inner * inner * low);
}

// At a Bingham number of 10 the layer that yields is some cells thick, at 1600 a tenth of one; the
// error falls at least in proportion to the cell (+13.9, +6.2, +2.6 % at R = 5, 10, 20), towards 0.
// (With the stress of covered cells taken alike on all planes they were 12.6, 6.0 and 2.5 %.)
TEST(BinghamBetweenCylinders, TorqueTendsToTheExactOne) {
  EXPECT_NEAR(bingham_torque(10.0, 10.0), 1.0, 0.01);
  const double coarse = bingham_torque(5.0, 1600.0) - 1.0,
               middle = bingham_torque(10.0, 1600.0) - 1.0,
               fine = bingham_torque(20.0, 1600.0) - 1.0;
  EXPECT_NEAR(coarse, 0.0, 0.145);
  EXPECT_LT(middle, 0.5 * coarse);
  EXPECT_LT(fine, 0.5 * middle);
  EXPECT_NEAR(middle, 0.0, 0.065);
  EXPECT_NEAR(fine, 0.0, 0.0325);
}

/// Load on a body over what it would weigh if the yield stress just held it, σ_y/(Δρ g D): the
/// critical yield number, from a body that creeps through a Bingham fluid 1600 times as stiff as
/// its plastic viscosity alone.
double critical_yield_number(int dimension, double diameter, int box,
                             const Vec3& off = {0.137, -0.211, 0.31}) {
  constexpr double tau = 3.0, speed = 1e-3, bingham = 1600.0;
  const Gel gel{.yield_part = bingham / (1.0 + bingham), .span = 30.0, .thinnest = 1e-4};
  const bool flat = dimension == 2;
  KernelChoice choice{.solid_term = SolidTerm::LayeredResistance,
                      .parameters = parameters_beside(0.5 * diameter, dimension,
                                                      gel.law(tau, speed / diameter), tau),
                      .lattice = flat ? VelocitySet::D2Q9 : VelocitySet::D3Q19};
  choice.parameters.magic = kResistanceMagic;
  Fluid fluid(flat ? Domain{box, box, Side::Wall, Side::Wall}
                   : Domain{box, box, Side::Wall, Side::Wall, box, Side::Wall},
              choice);
  const double middle = box / 2;
  fluid.place(
      std::vector<Body>{{1,
                         {middle + off.x(), middle + off.y(), flat ? 0.0 : middle + off.z()},
                         0.5 * diameter,
                         {speed, 0.0, 0.0}}});
  const double yield = gel.yield_part * (tau - 0.5) / 3.0 * speed / diameter;
  double load = 0.0;  // it trembles by 1.5 %: cells yield and set again
  fluid.advance(2000);
  for (int look = 0; look < 10; ++look) {
    fluid.advance(50);
    load -= 0.1 * fluid.loads()[0].force.x() / (yield * std::pow(diameter, dimension - 1));
  }
  return (flat ? pi / 4.0 : pi / 6.0) / load;
}

// The layer that yields beside the body becomes thinner than a cell, which the lattice makes
// stiffer than it is: the numbers come from below.
TEST(YieldNumber, OfADiscIsThatOfPlasticityTheory) {
  // F = (4 √2 + 2 π) σ_y D on a rough disc [RandolphHoulsby1984]
  const double limit = pi / 4.0 / (4.0 * std::sqrt(2.0) + 2.0 * pi);
  for (const double diameter : {10.0, 20.0}) {
    const double number = critical_yield_number(2, diameter, 5 * static_cast<int>(diameter));
    RecordProperty("number" + std::to_string(static_cast<int>(diameter)), std::to_string(number));
    EXPECT_GE(number / limit, 0.9) << diameter;
    EXPECT_LE(number / limit, 1.0) << diameter;
  }
}

// 0.0460 at this Bingham number (tests/reference/sphere_in_gel.py), of which 2 π R² σ_y/F = 0.143
// [Beris1985], 3 σ_y/(Δρ g D) = 0.0477, is the limit.
TEST(YieldNumber, OfASphereIsThatOfTheVariationalSolution) {
  double mean = 0.0;  // over places in a cell, which differ by 2 %
  for (const Vec3& off : {Vec3(0.137, -0.211, 0.31), Vec3(-0.4, 0.1, 0.25), Vec3(0.3, 0.45, -0.15)})
    mean += critical_yield_number(3, 10.0, 32, off) / 3.0;
  RecordProperty("number", std::to_string(mean));
  EXPECT_GE(mean / 0.0460, 0.88);  // of first order in the cell: 1.1 cells over D
  EXPECT_LE(mean / 0.0460, 1.0);
}

TEST(YieldNumber, Slow_OfASphereIsThatOfBeris) {
  for (const auto& [diameter, box] : {std::pair{14.0, 44}, {20.0, 56}}) {
    const double number = critical_yield_number(3, diameter, box);
    RecordProperty("number" + std::to_string(static_cast<int>(diameter)), std::to_string(number));
    EXPECT_GE(number / 0.0460, 1.0 - 1.2 / diameter) << diameter;
    EXPECT_LE(number / 0.0460, 1.0) << diameter;
    if (diameter >= 20.0) {
      EXPECT_GE(number / (0.143 / 3.0), 0.9);
    }
  }
}

// Nothing yields: the whole channel is a Newtonian fluid with nu_max, from rest on.
TEST(YieldStress, HoldsAChannelButForItsCreep) {
  constexpr int n = 16;
  constexpr double tau = 0.8, rate = 1e-3;
  const Gel gel{.yield_part = 0.5, .span = 50.0};
  const double nu_max = 50.0 * (tau - 0.5) / 3.0, yield = 0.5 * (tau - 0.5) / 3.0 * rate;
  const double force = 0.8 * yield / (0.5 * n);
  Fluid fluid({8, n, Side::Periodic, Side::Wall},
              {.force = true, .parameters = parameters(gel.law(tau, rate), tau, force)});
  fluid.advance(4000);
  for (int y = 0; y < n; ++y)
    EXPECT_NEAR(fluid.cell(3, y).u.x() / (force * n * n / (8.0 * nu_max)),
                4.0 * (y + 0.5) * (n - y - 0.5) / (n * n), 1e-3)
        << y;
}

}  // namespace
