// SPDX-License-Identifier: GPL-2.0-or-later
/// Fluids whose viscosity depends on the shear rate in a round pipe of covered cells, off the
/// centre of a cell, against the exact flow rate.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/resistance.h"
#include "tests/support/flux.h"
#include "tests/support/gels.h"
#include "tests/support/meshes.h"

namespace {

using namespace lbm;
using std::numbers::pi;
using test::Gel, test::parameters;

/// A slice of a pipe along x, repeated without an end, with a fluid that a body force drives; τ = 1
/// at the wall.
class Pipe {
 public:
  Pipe(const Gel& gel, int diameter)
      : gel_(gel), radius_(0.5 * diameter), wall_rate_(2.56 / (diameter * diameter)) {}

  /// Of the flow rate, Q = π ∫ r² γ̇ dr with the stress r/R times that at the wall.
  double error() const {
    constexpr double tau = 1.0;
    constexpr int along = 4, parts = 20000;
    const int size = 2 * static_cast<int>(std::ceil(radius_)) + 4;
    const double force = 2.0 * (tau - 0.5) / 3.0 * wall_rate_ / radius_;
    KernelChoice choice{.force = true,
                        .solid_term = SolidTerm::Resistance,
                        .parameters = parameters(gel_.law(tau, wall_rate_), tau, force),
                        .lattice = VelocitySet::D3Q19};
    choice.parameters.magic = kResistanceMagic;
    const Side p = Side::Periodic;
    Fluid fluid({along, size, p, p, size, p}, choice);
    const Vec3 middle(0.5 * along, 0.5 * size + 0.21, 0.5 * size - 0.37), far(100.0, 0.0, 0.0);
    fluid.add({MeshSolid{std::make_shared<const TriangleMesh>(
                             test::cylinder_mesh(middle - far, middle + far, radius_, 256)),
                         true}});
    double exact = 0.0;
    std::vector<double> start(parts + 1);  // the profile, from the wall on
    for (int i = parts - 1; i >= 0; --i) {
      const double r = (i + 0.5) * radius_ / parts, step = radius_ / parts;
      const double rate = wall_rate_ * gel_.shear_rate(r / radius_);
      exact += pi * r * r * rate * step;
      start[i] = start[i + 1] + rate * step;
    }
    for (int z = 0; z < size; ++z)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < along; ++x) {
          const double r = std::hypot(y + 0.5 - middle.y(), z + 0.5 - middle.z()) / radius_;
          const double u = r < 1.0 ? start[static_cast<std::size_t>(r * parts)] : 0.0;
          fluid.set_equilibrium({x, y, z}, 1.0, {u, 0.0, 0.0});
        }
    const auto flow = [&] { return test::flux(fluid).x() * size * size; };
    return test::settled(fluid, 30000, flow) / exact - 1.0;
  }

 private:
  Gel gel_;
  double radius_, wall_rate_;
};

constexpr double kAsked = 0.01;  // of the flow rate, at 32 cells
const Gel kMostSensitive{.index = 0.5, .yield_part = 0.5};

// The shear rate at the wall changes four times as much as the stress, and the pipe is sheared in
// its outer half only: of all fluids here this one's flow shows most of an error of a cell's stress
// (+4.6 % where that was 6 % off in cells beside a slanted wall, +0.5 % now).
TEST(GelPipe, FlowRateOfAHerschelBulkleyFluid) {
  const double error = Pipe(kMostSensitive, 32).error();
  RecordProperty("error", std::to_string(error));
  EXPECT_LT(std::abs(error), kAsked);
}

// A Newtonian fluid is off by +0.35 %, of first order in the cell: where the pipe's wall lies. What
// the fluids differ from it is of second order at least: a quarter of it is left at twice as many
// cells. (+0.34, +0.35, +0.35 % with n = 0.5, 0.8, 1.5; +0.44 % Bingham, +0.46 % Herschel–Bulkley.)
TEST(GelPipe, Slow_FlowRatesOfAllFluids) {
  const double newtonian[] = {Pipe({}, 16).error(), Pipe({}, 32).error()};
  EXPECT_LT(std::abs(newtonian[1]), 0.005);
  for (const Gel& gel : {Gel{.index = 0.5}, Gel{.index = 0.8}, Gel{.index = 1.5},
                         Gel{.yield_part = 0.5}, kMostSensitive}) {
    const double coarse = Pipe(gel, 16).error(), fine = Pipe(gel, 32).error();
    const std::string name =
        "n" + std::to_string(gel.index) + "_yield" + std::to_string(gel.yield_part);
    RecordProperty(name, std::to_string(coarse) + " " + std::to_string(fine));
    EXPECT_LT(std::abs(fine), kAsked) << name;
    // and 0.05 % that creep with nu_max adds at any cell
    EXPECT_LT(std::abs(fine - newtonian[1]), 0.25 * std::abs(coarse - newtonian[0]) + 5e-4) << name;
  }
}

}  // namespace
