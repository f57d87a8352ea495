// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/geometry.h"

#include <algorithm>
#include <vector>

#include "lbm_solver/immersed/footprint.h"
#include "lbm_solver/immersed/mapped_radius.h"
#include "lbm_solver/immersed/mesh_fractions.h"

namespace lbm {
namespace {

using Take = std::function<void(const FractionSpan&)>;

/// One of several functions, by the type that it takes.
template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};

/// The part of [from, to) of the box that a rank sweeps, counted from its first cell.
struct Cut {
  int begin[3], end[3];
  bool empty = false;

  Cut(const Cell3& from, const Cell3& to, const Block& cells) {
    for (int a = 0; a < 3; ++a) {
      begin[a] = std::max(0, from[a] - cells.begin[a]);
      end[a] = std::min(cells.size[a], to[a] - cells.begin[a]);
      empty = empty || begin[a] >= end[a];
    }
  }
};

/// Rows of a cut, each with the fractions that `fraction` says of its cells.
template <class Fraction>
void each_row(const Cut& cut, const Take& take, Fraction&& fraction) {
  if (cut.empty) return;
  std::vector<double> row(cut.end[0] - cut.begin[0]);
  for (int z = cut.begin[2]; z < cut.end[2]; ++z)
    for (int y = cut.begin[1]; y < cut.end[1]; ++y) {
      for (int x = cut.begin[0]; x < cut.end[0]; ++x) row[x - cut.begin[0]] = fraction(x, y, z);
      take({cut.begin[0], y, z, row});
    }
}

void fill_ball(const Ball& ball, const Domain& domain, const Block& cells, const RadiusShift& shift,
               const Take& take) {
  Body body;
  body.centre = ball.centre;
  body.radius = mapped_radius(shift, ball.radius, ball.hollow);
  body.hollow = ball.hollow;
  Footprint footprint;
  footprint.look(body, domain, cells);
  footprint.write();
  std::vector<double> row;
  for (const auto& span : footprint.spans()) {
    row.clear();
    for (int k = 0; k < span.blocks; ++k)
      for (const double cover : footprint.blocks()[span.first + k].cover)
        row.push_back(fraction_of(cover));
    row.resize(std::min<std::size_t>(row.size(), cells.size[0] - span.x()));
    take({span.x(), span.y, span.z, row});
  }
}

/// @param flat  two dimensions: a picture has no depth
void fill_voxels(const VoxelSolid& solid, bool flat, const Block& cells, const Take& take) {
  const Voxels& voxels = *solid.voxels;
  Cell3 to;
  for (int a = 0; a < 3; ++a) to[a] = solid.at[a] + (a == 2 && flat ? 1 : solid.cells(a));
  const int n = solid.coarser, deep = flat ? 1 : n;
  const double each = 1.0 / (static_cast<double>(n) * n * deep);
  each_row(Cut(solid.at, to, cells), take, [&](int x, int y, int z) {
    const Cell3 cell{x, y, z};
    int first[3];
    for (int a = 0; a < 3; ++a)
      first[a] = (cell[a] + cells.begin[a] - solid.at[a]) * n / (a == 2 && flat ? 1 : solid.finer);
    if (n == 1)
      return static_cast<double>(voxels.solid[voxels.index(first[0], first[1], first[2])]);
    double sum = 0.0;
    for (int k = 0; k < deep; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
          sum += voxels.solid[voxels.index(first[0] + i, first[1] + j, first[2] + k)];
    return each * sum;
  });
}

}  // namespace

Vec3 Geometry::centre() const {
  return std::visit(Overloaded{[](const Ball& ball) { return ball.centre; },
                               [](const CellBox& box) { return box.centre(); },
                               [](const MeshSolid& solid) {
                                 const auto [low, high] = bounds(*solid.mesh);
                                 return Vec3(0.5 * (low + high));
                               },
                               [](const VoxelSolid& solid) {
                                 Vec3 middle;
                                 for (int a = 0; a < 3; ++a)
                                   middle[a] = solid.at[a] + 0.5 * solid.cells(a);
                                 return middle;
                               }},
                    shape);
}

void fill(const Geometry& geometry, const Domain& domain, const Block& cells,
          const RadiusShift& shift, const Take& take) {
  std::visit(
      Overloaded{
          [&](const Ball& ball) { fill_ball(ball, domain, cells, shift, take); },
          [&](const CellBox& box) {
            each_row(Cut(box.from, box.to, cells), take, [](int, int, int) { return 1.0; });
          },
          [&](const MeshSolid& solid) { fill_mesh(*solid.mesh, solid.hollow, cells, shift, take); },
          [&](const VoxelSolid& solid) {
            fill_voxels(solid, domain.dimension() == 2, cells, take);
          }},
      geometry.shape);
}

}  // namespace lbm
