// SPDX-License-Identifier: GPL-2.0-or-later
/// The eddy viscosity that adapts to walls, from velocities whose gradients are known.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "lbm_solver/solver/fluid.h"

namespace {

using namespace lbm;

KernelChoice choice_of(VelocitySet lattice, double smagorinsky = 0.1) {
  return {.collision = CollisionOperator::CentralMoment,
          .parameters = {.tau = 0.6, .smagorinsky = smagorinsky},
          .lattice = lattice,
          .eddies = EddyModel::Wale};
}

/// A fluid that moves as told, after its first step: the factors are those of its beginning.
template <class Velocity>
Fluid moving(const Domain& domain, const Velocity& u) {
  Fluid fluid(domain, choice_of(domain.dimension() == 3 ? VelocitySet::D3Q19 : VelocitySet::D2Q9));
  for (int z = 0; z < domain.nz; ++z)
    for (int y = 0; y < domain.ny; ++y)
      for (int x = 0; x < domain.nx; ++x)
        fluid.set_equilibrium({x, y, z}, 1.0, u(Vec3(x + 0.5, y + 0.5, z + 0.5)));
  fluid.step();
  return fluid;
}

/// As it is printed in [NicoudDucros1999], over √(2 S_ab S_ab).
double naive_factor(const Eigen::Matrix3d& g) {
  const Eigen::Matrix3d s = 0.5 * (g + g.transpose()), g2 = g * g;
  const Eigen::Matrix3d d =
      0.5 * (g2 + g2.transpose()) - g2.trace() / 3.0 * Eigen::Matrix3d::Identity();
  const double ss = s.squaredNorm(), dd = d.squaredNorm();
  const double op = std::pow(dd, 1.5) / (std::pow(ss, 2.5) + std::pow(dd, 1.25));
  return std::min(10.6, 10.6 * op / std::sqrt(2.0 * ss));
}

// Central differences of a linear velocity are exact; velocities are kept in single precision,
// 1e-7 of 0.01 over gradients of 1e-3.
TEST(Wale, FactorIsThatOfTheGradient) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1e-3, 1e-3);
  for (int k = 0; k < 10; ++k) {
    Eigen::Matrix3d g = Eigen::Matrix3d::NullaryExpr([&] { return number(random); });
    g(2, 2) = -g(0, 0) - g(1, 1);
    const Fluid fluid =
        moving({6, 6, Side::Wall, Side::Wall, 6, Side::Wall}, [&](const Vec3& at) -> Vec3 {
          const Eigen::Vector3d u = g * Eigen::Vector3d(at.x() - 3.0, at.y() - 3.0, at.z() - 3.0);
          return Vec3(u[0], u[1], u[2]);
        });
    for (const int cell : {0, 3, 5})  // beside walls differences are one-sided
      EXPECT_NEAR(fluid.eddies()->row(cell, cell)[cell] / naive_factor(g), 1.0, 1e-3) << k;
  }
}

TEST(Wale, VanishesInPlaneShearAndIsBoundedInASolidsRotation) {
  const Domain domain{8, 8, Side::Wall, Side::Wall};
  const Fluid shear = moving(domain, [](const Vec3& at) -> Vec3 { return {1e-3 * at.y(), 0.0}; });
  EXPECT_LT(shear.eddies()->row(4, 0)[4], 1e-6);
  const Fluid rotation = moving(domain, [](const Vec3& at) -> Vec3 {
    return {1e-3 * (4.0 - at.y()), 1e-3 * (at.x() - 4.0)};
  });
  EXPECT_LE(rotation.eddies()->row(4, 0)[4], 10.6f);
}

// u = y, w = y sin kz, v = -½ k y² cos kz beside a wall at y = 0: S^d ∝ y, κ ∝ y³ as ky → 0. In two
// dimensions g² has no shear, and κ falls faster.
TEST(Wale, VanishesAsTheCubeOfTheDistanceFromAWall) {
  const double k = 2.0 * std::numbers::pi / 256;
  const Domain domain{4, 16, Side::Periodic, Side::Wall, 256, Side::Periodic};
  const Fluid fluid = moving(domain, [&](const Vec3& at) -> Vec3 {
    return 1e-3 * Vec3(at.y(), -0.5 * k * at.y() * at.y() * std::cos(k * at.z()),
                       at.y() * std::sin(k * at.z()));
  });
  const auto at = [&](int y) { return fluid.eddies()->row(y, 20)[2]; };
  EXPECT_NEAR(std::log(at(4) / at(1)) / std::log(4.5 / 1.5), 3.0, 0.2);
}

// Across a plane channel every gradient is a shear: the parabola stays as it is without the model.
TEST(Wale, LeavesALaminarChannelAlone) {
  KernelChoice choice = choice_of(VelocitySet::D2Q9, 0.3);
  choice.force = true;
  choice.parameters.force_x = 1e-5;
  Fluid with({8, 16, Side::Periodic, Side::Wall}, choice);
  choice.parameters.smagorinsky = 0.0;
  Fluid without({8, 16, Side::Periodic, Side::Wall}, choice);
  for (Fluid* fluid : {&with, &without}) fluid->advance(5000);
  for (int y = 0; y < 16; ++y)
    EXPECT_NEAR(with.cell(3, y).u.x() / without.cell(3, y).u.x(), 1.0, 1e-9) << y;
}

TEST(Wale, GoesOnToTheBit) {
  const auto whirls = [](const Vec3& at) -> Vec3 {
    return 0.02 * Vec3(std::sin(at.y()) + std::cos(at.z()), std::sin(at.z()) + std::cos(at.x()),
                       std::sin(at.x()) + std::cos(at.y()));
  };
  const Domain domain{12, 10, Side::Periodic, Side::Wall, 8, Side::Periodic};
  Fluid first = moving(domain, whirls), second(domain, choice_of(VelocitySet::D3Q19));
  first.advance(12);
  second.load(first.save());
  for (Fluid* fluid : {&first, &second}) fluid->advance(10);
  EXPECT_TRUE(first.save() == second.save());
}

}  // namespace
