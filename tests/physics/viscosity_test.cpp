// SPDX-License-Identifier: GPL-2.0-or-later
/// Viscosities that depend on the shear rate, against exact solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/viscosity_use.h"
#include "tests/support/gels.h"
#include "tests/support/openings.h"

namespace {

using namespace lbm;
using std::numbers::pi;
using test::Gel, test::parameters, test::parameters_beside, test::settled;
using Regularisation = ViscosityScene::Regularisation;

struct Channel {
  double error;     ///< of the flow rate
  double plug;      ///< width of what is not sheared, over the channel's
  double at_bound;  ///< share of cells at nu_max
};

/// A channel of some cells under a body force, whose walls have τ = 1.
Channel plane_channel(const Gel& gel, int height) {
  constexpr double tau = 1.0;
  const double wall_rate = 2.56 / (height * height);  // diffusive scaling
  const ViscosityLaw law = gel.law(tau, wall_rate);
  const double wall_stress = (tau - 0.5) / 3.0 * wall_rate, half = 0.5 * height;
  Fluid fluid({8, height, Side::Periodic, Side::Wall},
              {.force = true, .parameters = parameters(law, tau, wall_stress / half)});
  // Q = 2 ∫ y γ̇(y) dy from the middle to the wall, and the profile to begin with
  constexpr int parts = 20000;
  const auto rate_at = [&](double y) { return wall_rate * gel.shear_rate(y / half); };
  double exact = 0.0, speed = 0.0;
  std::vector<double> start(static_cast<std::size_t>(height));
  for (int i = parts - 1; i >= 0; --i) {
    const double y = (i + 0.5) * half / parts, step = half / parts;
    exact += 2.0 * y * rate_at(y) * step;
    speed += rate_at(y) * step;
    for (const double sign : {-1.0, 1.0})
      start[static_cast<std::size_t>(std::clamp(half + sign * y, 0.0, height - 1.0))] = speed;
  }
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < 8; ++x) fluid.set_equilibrium(x, y, 1.0, {start[y], 0.0});
  const double flow = settled(fluid, 60000, [&] {
    double sum = 0.0;
    for (int y = 0; y < height; ++y) sum += fluid.cell(3, y).u.x();
    return sum;
  });
  int still = 0;
  for (int y = 1; y < height; ++y)
    still += std::abs(fluid.cell(3, y).u.x() - fluid.cell(3, y - 1).u.x()) < 0.02 * wall_rate;
  return {flow / exact - 1.0, static_cast<double>(still) / height,
          viscosity_use(fluid, parameters(law, tau)).at_rest_bound};
}

/// Keeps a number for the test's report (--gtest_output=xml), by the fluid's index.
void record(const std::string& what, double index, double value) {
  testing::Test::RecordProperty(what + "_n" + std::to_string(index).substr(0, 3),
                                std::to_string(value));
}

// Second order in the cell; 1 % at 32 cells is what is asked for, 0.25 % what is there. With n =
// 0.5 and 0.8 errors of both signs add up, so that only the fluid that is farthest off shows its
// order.
TEST(PlanePoiseuille, PowerLawFlowRates) {
  for (const double n : {0.5, 0.8, 1.5}) {
    const double coarse = plane_channel({.index = n}, 16).error,
                 fine = plane_channel({.index = n}, 32).error;
    record("error16", n, coarse);
    record("error32", n, fine);
    EXPECT_LT(std::abs(fine), 0.0025) << "n = " << n;
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.3) << "n = " << n;
  }
}

TEST(PlanePoiseuille, BinghamAndHerschelBulkleyFlowRatesAndPlug) {
  for (const double n : {1.0, 0.5}) {
    const Channel flow = plane_channel({.index = n, .yield_part = 0.5}, 32);
    record("error32", n, flow.error);
    record("plug", n, flow.plug);
    EXPECT_LT(std::abs(flow.error), 0.005) << "n = " << n;
    // half of the channel is a plug; a stiff cell more or less on either side, more for n = 0.5,
    // where the shear rate grows slowly from the plug's edge
    EXPECT_NEAR(flow.plug, 0.5, n == 1.0 ? 2.1 / 32 : 6.1 / 32) << "n = " << n;
    EXPECT_NEAR(flow.at_bound, 0.5, 2.1 / 32) << "n = " << n;
  }
}

// Where the shear rate grows slowly from the plug's edge coarse cells show it: -1.7 % at 16 cells,
// a tenth of it at 32.
TEST(PlanePoiseuille, HerschelBulkleyAtSixteenCells) {
  EXPECT_LT(std::abs(plane_channel({.index = 0.5, .yield_part = 0.5}, 16).error), 0.02);
}

// A plug of more than half of the channel leaves few cells to the shear: +1.3 % with 0.8 of the
// width, 3.2 of 32 cells a side, and -2 % with 0.9.
TEST(PlanePoiseuille, AWidePlugIsLessExact) {
  EXPECT_LT(std::abs(plane_channel({.yield_part = 0.8}, 32).error), 0.015);
  EXPECT_LT(std::abs(plane_channel({.yield_part = 0.9}, 32).error), 0.025);
}

// What creeps below the yield stress adds to the flow: in proportion to 1/nu_max. At the same bound
// Papanastasiou's law, which is softer above it too, is three times as far off.
TEST(PlanePoiseuille, RegularisationAddsToTheFlowInProportionToItsBound) {
  const auto error = [](double span, Regularisation kind) {
    return plane_channel({.yield_part = 0.5, .span = span, .regularisation = kind}, 32).error;
  };
  const double bi = error(100.0, Regularisation::BiViscosity),
               soft = error(100.0, Regularisation::Papanastasiou),
               limit = error(1000.0, Regularisation::BiViscosity),
               soft_limit = error(1000.0, Regularisation::Papanastasiou);
  EXPECT_GT(soft - soft_limit, 1.5 * (bi - limit));
  EXPECT_GT(bi - limit, 5e-4);
  EXPECT_LT(soft, 0.005);
  EXPECT_LT(std::abs(limit), 0.002);
}

// Uniform shear: every cell has the same viscosity, so the profile is straight and the walls do not
// slip; the wall's stress is that of the law.
TEST(PlaneCouette, IsStraightWithoutSlipInEveryFluid) {
  constexpr int n = 12;
  constexpr double tau = 0.8, lid = 0.02, rate = lid / n;
  for (const Gel& gel :
       {Gel{.index = 0.5}, Gel{.index = 1.5}, Gel{.index = 1.0, .yield_part = 0.7}}) {
    Fluid fluid({8, n, Side::Periodic, Side::Wall},
                {.parameters = parameters(gel.law(tau, rate), tau)});
    test::add_velocity(fluid, Opening::whole(fluid.domain(), SideName::Top), {lid, 0.0});
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < 8; ++x) fluid.set_equilibrium(x, y, 1.0, {rate * (y + 0.5), 0.0});
    fluid.advance(8000);
    double most = 0.0;
    for (int y = 0; y < n; ++y) {
      const double off = fluid.cell(3, y).u.x() / lid - (y + 0.5) / n;
      most = std::max(most, std::abs(off));
      EXPECT_NEAR(off, 0.0, 2e-4) << gel.index << ' ' << y;
    }
    record("off_in_1e6", gel.index, 1e6 * most);
    const ViscosityUse use = viscosity_use(fluid, parameters(gel.law(tau, rate), tau));
    EXPECT_NEAR(use.largest_shear / rate, 1.0, 2e-3) << gel.index;
    EXPECT_NEAR(use.mean_viscosity * 3.0 / (tau - 0.5), 1.0, 3e-3) << gel.index;
  }
}

struct Annulus {
  double torque, mean_viscosity;  ///< over the exact ones
};
/// Between a cylinder that turns and a hollow one at rest. The exact solution is
///   ω = (T/2πK)^{1/n} (n/2) (R₁^{-2/n} - R₂^{-2/n}),   ν ∝ r^m,   m = 2/n - 2
Annulus taylor_couette(double index, double inner, double outer) {
  constexpr double tau = 1.0;
  const int size = 2 * static_cast<int>(std::ceil(outer)) + 6;
  const double surface_rate = 0.0015, nu = (tau - 0.5) / 3.0;  // at the inner cylinder
  const Gel gel{.index = index};
  const auto law = parameters_beside(inner, 2, gel.law(tau, surface_rate), tau);
  Fluid fluid({size, size}, {.solid_term = SolidTerm::Resistance, .parameters = law});
  const double exact = 2.0 * pi * inner * inner * nu * surface_rate;
  const double spin = surface_rate * 0.5 * index * (1.0 - std::pow(inner / outer, 2.0 / index));
  const Vec3 centre(0.5 * size + 0.137, 0.5 * size - 0.211);
  const std::vector<Body> cylinders{{1, centre, inner, Vec3(), Spin(spin)},
                                    {2, centre, outer, Vec3(), Spin(), true}};
  fluid.place(cylinders);
  const double torque = settled(fluid, 12000, [&] { return -fluid.loads()[0].torque.z(); });
  const double m = 2.0 / index - 2.0, ratio = outer / inner;
  const double mean =
      nu * 2.0 / (m + 2.0) * (std::pow(ratio, m + 2.0) - 1.0) / (ratio * ratio - 1.0);
  return {torque / exact, viscosity_use(fluid, law).mean_viscosity / mean};
}

TEST(TaylorCouette, TorqueOfAPowerLawFluid) {
  for (const double n : {0.5, 0.8, 1.5}) {
    const double torque = taylor_couette(n, 10.0, 20.0).torque;
    record("torque", n, torque);
    EXPECT_NEAR(torque, 1.0, 0.02) << n;
  }
}

// A fifth of the gap's cells are covered in part: they count with their fluid, and its stress.
TEST(TaylorCouette, MeanViscosityCountsTheFluidOfCoveredCells) {
  for (const double n : {0.5, 1.5})
    EXPECT_NEAR(taylor_couette(n, 10.0, 20.0).mean_viscosity, 1.0, 0.02) << n;
}

/// Drag of a sphere that moves in the middle of a hollow one, four times as wide and at rest, over
/// 3 π K D² (U/D)ⁿ.
double sphere_drag(double index, double radius) {
  constexpr double tau = 1.0;
  const int size = 2 * static_cast<int>(std::ceil(4.0 * radius)) + 4;
  const double speed = 5e-4, rate = speed / (2.0 * radius), nu = (tau - 0.5) / 3.0;
  KernelChoice choice{
      .solid_term = SolidTerm::LayeredResistance,
      .parameters = parameters_beside(radius, 3, Gel{.index = index}.law(tau, rate), tau),
      .lattice = VelocitySet::D3Q19};
  choice.parameters.magic = kResistanceMagic;
  Fluid fluid({size, size, Side::Wall, Side::Wall, size, Side::Wall}, choice);
  const Vec3 centre(0.5 * size + 0.137, 0.5 * size - 0.211, 0.5 * size + 0.31);
  fluid.place(std::vector<Body>{{1, centre, radius, {speed, 0.0, 0.0}},
                                {2, centre, 4.0 * radius, Vec3(), Spin(), true}});
  const double stokes = 3.0 * pi * nu * 2.0 * radius * speed;
  return settled(fluid, 3000, [&] { return -fluid.loads()[0].force.x(); }) / stokes;
}

// The references are those of a variational solution of the same problem (docs/viscosity.md); 5 %
// is what is asked for at ten cells across.
TEST(Sphere, DragInAPowerLawFluid) {
  const double part = sphere_drag(0.5, 5.0) / 1.7104;
  record("drag", 0.5, part);
  EXPECT_NEAR(part, 1.0, 0.05);
}

TEST(Sphere, Slow_DragInPowerLawFluids) {
  const std::pair<double, double> cases[]{
      {1.5, 2.4844}, {1.0, 2.1049}, {0.8, 1.9501}, {0.3, 1.5421}};
  for (const auto& [index, exact] : cases) {
    const double part = sphere_drag(index, 5.0) / exact;
    record("drag", index, part);
    EXPECT_NEAR(part, 1.0, 0.05) << "n = " << index;
  }
}

// From rest under the whole force at once, with every operator: thin fluids, n = 0.3, a yield
// stress, τ from 0.5003 to 17 within one channel. The exact largest speeds are 0.04 … 0.33 of the
// wall's shear rate times the channel's height; half of it would be that of a channel which is
// sheared everywhere as at its walls.
TEST(HardCases, StayBoundedWithEveryOperator) {
  constexpr int n = 24;
  for (const CollisionOperator collision : choices<CollisionOperator>())
    for (const double tau : {0.53, 1.0})
      for (const Gel& gel :
           {Gel{.index = 0.3}, Gel{.index = 0.5, .yield_part = 0.7}, Gel{.index = 2.0}}) {
        const double rate = 0.64 / (n * n), force = (tau - 0.5) / 3.0 * rate / (0.5 * n);
        Fluid fluid({8, n, Side::Periodic, Side::Wall},
                    {.collision = collision,
                     .force = true,
                     .parameters = parameters(gel.law(tau, rate), tau, force)});
        for (int look = 0; look < 20; ++look) {
          fluid.advance(500);
          const auto all = fluid.extremes();
          ASSERT_TRUE(all.finite && all.max_speed < 0.5 * rate * n)
              << collision << " τ " << tau << " n " << gel.index << ' '
              << all.max_speed / (rate * n);
        }
      }
}

}  // namespace
