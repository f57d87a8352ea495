// SPDX-License-Identifier: GPL-2.0-or-later
/// Bodies in slow flow with an exact reference: arrays of discs and spheres, torques.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/support/array_references.h"

namespace test {

using namespace lbm;

/// A fluid at rest with TRT and a solid term. @param g  body force on a cell
inline Fluid slow_fluid(SolidTerm term, const Domain& domain, double tau, const Vec3& g) {
  const bool flat = domain.dimension() == 2;
  KernelChoice choice{.force = g.norm() > 0.0,
                      .solid_term = term,
                      .parameters = {.tau = tau,
                                     .magic = by_resistance(term) ? kResistanceMagic : 3.0 / 16.0,
                                     .force_x = g.x(),
                                     .force_y = g.y(),
                                     .force_z = g.z()},
                      .weight = flat ? WeightRule::Viscous : WeightRule::Balanced,
                      .lattice = flat ? VelocitySet::D2Q9 : VelocitySet::D3Q19};
  Fluid fluid(domain, choice);
  for (int z = 0; z < domain.nz; ++z)
    for (int y = 0; y < domain.ny; ++y)
      for (int x = 0; x < domain.nx; ++x) fluid.set_equilibrium({x, y, z}, 1.0, Vec3());
  return fluid;
}

/// Mean velocity along x of the cells at x = 0, half-way through two steps.
inline double flux(Fluid& fluid) {
  const Domain& d = fluid.domain();
  double sum = 0.0;
  for (int step = 0; step < 2; ++step) {
    for (int z = 0; z < d.nz; ++z)
      for (int y = 0; y < d.ny; ++y) sum += fluid.cell(0, y, z).u.x();
    if (step == 0) fluid.advance(1);
  }
  return sum / (2.0 * d.ny * d.nz);
}

/// Error of the drag of an array at Re = 0.01, in per cent; n cells a period, the body's centre
/// `offset` from a cell's corner. Not a number where it blows up.
inline double array_error(SolidTerm term, int dimension, double fraction, int n, double tau,
                          const Vec3& offset) {
  const bool flat = dimension == 2;
  const double nu = (tau - 0.5) / 3.0, pi = std::numbers::pi;
  const double radius =
      n * (flat ? std::sqrt(fraction / pi) : std::cbrt(fraction * 3.0 / (4.0 * pi)));
  const double drag = flat ? kDiscDrag.at(fraction) : 6.0 * pi * radius * kSphereDrag.at(fraction);
  const double volume = flat ? n * n : 1.0 * n * n * n, speed = 0.005 * nu / radius * 10.0 / drag;
  const double g = drag * nu * speed / volume;
  Fluid fluid =
      slow_fluid(term, {n, n, Side::Periodic, Side::Periodic, flat ? 1 : n, Side::Periodic}, tau,
                 {g, 0.0, 0.0});
  const Vec3 middle(n / 2, n / 2, flat ? 0 : n / 2);
  fluid.place(std::vector<Body>{{1, middle + offset, radius, Vec3(), Spin()}});
  const int chunk = std::max(20, static_cast<int>(volume / (nu * drag)));
  double before = 0.0, now = 0.0;
  for (int k = 0; k < 60; ++k) {
    fluid.advance(chunk);
    now = flux(fluid);
    if (!(std::abs(now) < 1e3 * speed)) return std::numeric_limits<double>::quiet_NaN();
    if (k > 2 && std::abs(now / before - 1.0) < 1e-5) break;
    before = now;
  }
  return 100.0 * (g * volume / (nu * now) / drag - 1.0);
}

/// Mean over places of a body within its cell, and the range over them.
struct Errors {
  double mean = 0.0, spread = 0.0;
};
inline Errors array_errors(SolidTerm term, int dimension, double fraction, int n, double tau) {
  Errors errors;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (Vec3 offset : kPlacesInACell) {
    if (dimension == 2) offset.z() = 0.0;
    const double e = array_error(term, dimension, fraction, n, tau, offset);
    errors.mean += e / static_cast<double>(kPlacesInACell.size());
    low = std::min(low, e);
    high = std::max(high, e);
  }
  errors.spread = high - low;
  return errors;
}

/// Error in per cent of the torque on a disc of a radius that spins in a ring of twice that.
inline double ring_torque_error(SolidTerm term, double radius, double tau, const Vec3& offset) {
  const double nu = (tau - 0.5) / 3.0, spin = 1e-3 * nu / radius, outer = 2.0 * radius;
  const int n = static_cast<int>(2.0 * outer) + 8;
  Fluid fluid = slow_fluid(term, {n, n, Side::Periodic, Side::Periodic}, tau, Vec3());
  const Vec3 centre = Vec3(n / 2, n / 2, 0.0) + offset;
  fluid.place(
      std::vector<Body>{{1, centre, radius, Vec3(), spin}, {2, centre, outer, Vec3(), 0.0, true}});
  fluid.advance(static_cast<int>(3.0 * radius * radius / nu));
  const double exact =
      4.0 * std::numbers::pi * nu * spin / (1.0 / (radius * radius) - 1.0 / (outer * outer));
  return 100.0 * (-fluid.loads()[0].torque.z() / exact - 1.0);
}

/// The same of a sphere in a periodic box of six radii: 8πμR³ω/(1 - φ) [Zuzovsky et al. 1983].
inline double sphere_torque_error(SolidTerm term, double radius, double tau, const Vec3& axis) {
  const double nu = (tau - 0.5) / 3.0, spin = 1e-3 * nu / radius, pi = std::numbers::pi;
  const int n = static_cast<int>(6.0 * radius);
  Fluid fluid =
      slow_fluid(term, {n, n, Side::Periodic, Side::Periodic, n, Side::Periodic}, tau, Vec3());
  const Vec3 centre(n / 2 + 0.13, n / 2 + 0.37, n / 2 + 0.25);
  fluid.place(std::vector<Body>{{1, centre, radius, Vec3(), Spin(spin * axis)}});
  fluid.advance(static_cast<int>(4.0 * radius * radius / nu));
  const double cube = radius * radius * radius,
               fraction = 4.0 / 3.0 * pi * cube / (1.0 * n * n * n);
  const double exact = 8.0 * pi * nu * cube * spin / (1.0 - fraction);
  return 100.0 * (-fluid.loads()[0].torque.dot(axis) / exact - 1.0);
}

}  // namespace test
