// SPDX-License-Identifier: GPL-2.0-or-later
/// Boxes, grids of ranks, states and bodies of the tests on several ranks.
#pragma once

#include <gtest/gtest.h>

#include <mpi.h>

#include <random>

#include "lbm_solver/solver/fluid.h"
#include "tests/support/moving_obstacles.h"

namespace test {

using namespace lbm;

inline int world_size() {
  int size = 0;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

/// A population of the random state, the same on whatever rank asks.
inline double noise(const Domain& d, int q, int x, int y, int z) {
  std::minstd_rand random(static_cast<unsigned>(((z * d.ny + y) * d.nx + x) * 27 + q + 1));
  random.discard(3);
  return 1e-3 * (2.0 * random() / std::minstd_rand::max() - 1.0);
}

inline void randomise(Fluid& fluid) {
  const Cell3 &n = fluid.cells().size, &b = fluid.cells().begin;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        for (int q = 0; q < fluid.lattice().Q; ++q)
          fluid.arriving(q, x, y, z) = noise(fluid.domain(), q, x + b[0], y + b[1], z + b[2]);
}

/// Sides with an inlet, an outlet and a lid where there are walls for them.
inline void add_patches(Fluid& fluid) {
  const Domain& d = fluid.domain();
  if (d.x == Side::Wall) {
    Opening in = Opening::whole(d, SideName::Left), out = Opening::whole(d, SideName::Right);
    if (!in.closed[0]) in.begin[0] = 2;  // begins within a rank, ends in another
    fluid.add(std::make_unique<VelocityPatch>(fluid.lattice(), fluid.links(in), Vec3(0.02, 0.0),
                                              true, in, InTime{}));
    fluid.add(std::make_unique<OutflowPatch>(fluid.links(out), out.side, 0.001, 0.01));
  }
  if (d.y == Side::Wall) {
    const Opening top = Opening::whole(d, SideName::Top);
    fluid.add(std::make_unique<PressurePatch>(fluid.links(top), top.side, 0.002, InTime{}));
  }
}

/// One wider than a subdomain over the middle of the box, one over its corner, one in contact with
/// the first.
inline std::vector<Body> bodies_in(const Domain& d) {
  const bool flat = d.dimension() == 2;
  const Vec3 middle(0.5 * d.nx + 0.3, 0.5 * d.ny - 0.2, flat ? 0.0 : 0.5 * d.nz + 0.4);
  std::vector<Body> bodies{{1, middle, 5.1, {0.01, -0.02, 0.01}, {0.001, 0.002, -0.003}},
                           {2, {0.3, 0.6, 0.2}, 3.2, {-0.01, 0.01, 0.02}, {0.002, 0.0, 0.001}},
                           {3, middle + Vec3(7.9, 0.4, 0.0), 2.7, {0.0, 0.01, 0.0}, Spin()}};
  for (Body& b : bodies)
    if (flat) {
      b.centre.z() = b.velocity.z() = 0.0;
      b.spin = b.spin.z();
    }
  return bodies;
}

/// Round-off of populations (deviations up to 0.05) and of a body's load. Loads are up to 1.7,
/// which floats round by 1e-7 each time that a cell's force is computed among other cells.
struct Limits {
  double population, load;
};
inline Limits limits(Precision precision, const Cell3& grid) {
  const bool whole_rows = grid[0] == 1;
  if (precision == Precision::Double) return {whole_rows ? 0.0 : 1e-16, 1e-13};
  return {whole_rows ? 0.0 : 2e-8, whole_rows ? 1e-13 : 5e-7};
}

inline void expect_same_cells(const Fluid& part, const Fluid& whole, double limit) {
  const Cell3 &n = part.cells().size, &b = part.cells().begin;
  double largest = 0.0;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        for (int q = 0; q < part.lattice().Q; ++q) {
          const double here = part.arriving(q, x, y, z);
          const double there = whole.arriving(q, x + b[0], y + b[1], z + b[2]);
          if (std::abs(here - there) > limit && largest == 0.0)
            ADD_FAILURE() << "rank " << part.ranks().rank() << ": f_" << q << " at " << x + b[0]
                          << ' ' << y + b[1] << ' ' << z + b[2] << " is " << here << ", alone "
                          << there;
          largest = std::max(largest, std::abs(here - there));
        }
  EXPECT_LE(largest, limit);
}

struct Box {
  VelocitySet lattice;
  Domain domain;
};

inline std::vector<Box> boxes() {
  std::vector<Box> all;
  const Side sides[] = {Side::Periodic, Side::Wall};
  for (const Side x : sides)
    for (const Side y : sides) {
      all.push_back({VelocitySet::D2Q9, {29, 23, x, y}});
      for (const Side z : sides)
        for (const VelocitySet lattice : {VelocitySet::D3Q19, VelocitySet::D3Q27})
          all.push_back({lattice, {23, 14, x, y, 13, z}});
    }
  return all;
}

/// Every grid of as many ranks as there are that leaves each two cells along an axis.
inline std::vector<Cell3> grids(const Domain& d) {
  std::vector<Cell3> all;
  const int n = world_size();
  for (int x = 1; x <= n; ++x)
    for (int y = 1; x * y <= n; ++y)
      if (n % (x * y) == 0 && d.nx >= 2 * x && d.ny >= 2 * y &&
          (x * y == n || d.nz >= 2 * n / (x * y)))
        all.push_back({x, y, n / (x * y)});
  return all;
}

/// Equal blocks and, beside them, blocks of quite different sizes.
inline std::vector<Cuts> cuts_of(const Domain& d, const Cell3& grid) {
  Cuts uneven = equal_cuts(d, grid);
  for (int a = 0; a < 3; ++a)
    for (int p = 1; p < grid[a]; ++p)  // every block but the last is as thin as may be
      uneven[a][p] = 2 * p;
  return {equal_cuts(d, grid), uneven};
}

inline KernelChoice choice_for(VelocitySet lattice, Precision precision) {
  return {.collision = CollisionOperator::Trt,
          .solid_term = SolidTerm::LayeredResistance,
          .parameters = {.tau = 0.7},
          .lattice = lattice,
          .precision = precision};
}

inline std::vector<double> numbers(const std::vector<BodyLoad>& loads) {
  std::vector<double> all;
  for (const BodyLoad& l : loads)
    for (const Vec3* v : {&l.force, &l.torque}) all.insert(all.end(), v->begin(), v->end());
  return all;
}

inline void expect_near(const std::vector<double>& a, const std::vector<double>& b, double limit) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], limit) << i;
}

}  // namespace test
