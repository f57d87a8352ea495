// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/wale.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lbm_solver/solver/fluid.h"

namespace lbm {
namespace {

constexpr double kIsotropic = 10.6;  // C_w²/S_c²

/// Calls f(cell of a layer) for one layer of cells across an axis.
template <class F>
void each_in_layer(const Cell3& n, int axis, int layer, F&& f) {
  Cell3 from{0, 0, 0}, to = n;
  from[axis] = layer;
  to[axis] = layer + 1;
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y)
      for (int x = from[0]; x < to[0]; ++x) f(Cell3{x, y, z});
}

}  // namespace

Wale::Wale(const Decomposition& ranks)
    : ranks_(ranks), n_(ranks.cells().size), dimension_(ranks.domain().dimension()), field_(n_) {
  for (auto& component : u_) component.assign(at(n_[0], n_[1], n_[2]) + 1, 0.0f);
}

void Wale::take_velocities(Fluid& fluid) {
#pragma omp parallel
  {
    std::vector<double> rho(n_[0]), u[3];
    for (auto& component : u) component.assign(n_[0], 0.0);
#pragma omp for schedule(static)
    for (int row = 0; row < n_[1] * n_[2]; ++row) {
      const int y = row % n_[1], z = row / n_[1];
      fluid.row(y, z, rho, {u[0], u[1], u[2]});
      for (int a = 0; a < 3; ++a)
        for (int x = 0; x < n_[0]; ++x) u_[a][at(x, y, z)] = static_cast<float>(u[a][x]);
    }
  }
}

/// Velocities beyond the faces of an axis: the other side's, the neighbour's, or straight on.
void Wale::fill_beyond(int axis) {
  const int last = n_[axis] - 1;
  std::vector<float> lists[2];
  for (int high = 0; high < 2; ++high)
    if (ranks_.neighbour(axis, high) >= 0)
      each_in_layer(n_, axis, high ? last : 0, [&](const Cell3& c) {
        for (const auto& component : u_) lists[high].push_back(component[at(c[0], c[1], c[2])]);
      });
  ranks_.exchange(axis, lists);
  for (int high = 0; high < 2; ++high) {
    const Face face = ranks_.cells().faces[axis][high];
    const int edge = high ? last : 0, inner = std::clamp(high ? last - 1 : 1, 0, last);
    auto next = lists[high].cbegin();
    each_in_layer(n_, axis, high ? last + 1 : -1, [&](const Cell3& beyond) {
      Cell3 near = beyond, far = beyond;
      near[axis] = face == Face::Periodic ? last - edge : edge;
      far[axis] = inner;
      for (auto& component : u_) {
        const float value = component[at(near[0], near[1], near[2])];
        component[at(beyond[0], beyond[1], beyond[2])] =
            face == Face::Neighbour ? *next++
            : face == Face::Wall    ? 2.0f * value - component[at(far[0], far[1], far[2])]
                                    : value;
      }
    });
  }
}

double Wale::factor(int x, int y, int z) const {
  const std::size_t here = at(x, y, z);
  const std::size_t steps[] = {1, at(x, y + 1, z) - here, at(x, y, z + 1) - here};
  const int d = dimension_;
  double g[3][3] = {}, s = 0.0, squares[3][3] = {}, trace = 0.0, wall = 0.0;
  for (int a = 0; a < d; ++a)
    for (int b = 0; b < d; ++b) g[a][b] = 0.5 * (u_[a][here + steps[b]] - u_[a][here - steps[b]]);
  for (int a = 0; a < d; ++a)
    for (int b = 0; b < d; ++b) {
      s += std::pow(0.5 * (g[a][b] + g[b][a]), 2);
      for (int c = 0; c < d; ++c) squares[a][b] += g[a][c] * g[c][b];
      trace += a == b ? squares[a][b] / 3.0 : 0.0;
    }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      wall += std::pow(0.5 * (squares[a][b] + squares[b][a]) - (a == b ? trace : 0.0), 2);
  const double ratio = wall / (s * s);  // D/s²: what is not shear over what is
  if (!std::isfinite(ratio)) return 0.0;
  const double root = std::sqrt(ratio), fourth = std::sqrt(root);
  return kIsotropic * std::min(1.0, ratio * root / (std::sqrt(2.0) * (1.0 + ratio * fourth)));
}

void Wale::update(Fluid& fluid) {
  take_velocities(fluid);
  for (int axis = 0; axis < dimension_; ++axis) fill_beyond(axis);
#pragma omp parallel for schedule(static)
  for (int row = 0; row < n_[1] * n_[2]; ++row) {
    float* kappa = field_.row(row % n_[1], row / n_[1]);
    for (int x = 0; x < n_[0]; ++x)
      kappa[x] = static_cast<float>(factor(x, row % n_[1], row / n_[1]));
  }
}

Record Wale::save() const {
  const CellRange here = range_of(ranks_.cells());
  const auto read = [this, here](const CellRange& piece, std::span<double> to) {
    piece.each([&](const Cell3& c, std::size_t number) {
      to[number] = field_.row(c[1] - here.begin[1], c[2] - here.begin[2])[c[0] - here.begin[0]];
    });
  };
  Record record;
  record.set("factors", CellValues{ranks_.domain().cells(), 1, true, here, read});
  return record;
}

void Wale::load(const Record& record) {
  const CellRange here = range_of(ranks_.cells());
  const CellValues& factors = record.cells("factors", ranks_.domain().cells(), 1);
  if (!factors.here.holds(here))
    throw std::invalid_argument("'factors' are of cells of another rank");
  for (const CellRange& piece : pieces_of(here, sizeof(double))) {
    std::vector<double> values(piece.count());
    factors.read(piece, values);
    piece.each([&](const Cell3& c, std::size_t number) {
      field_.row(c[1] - here.begin[1], c[2] - here.begin[2])[c[0] - here.begin[0]] =
          static_cast<float>(values[number]);
    });
  }
}

}  // namespace lbm
