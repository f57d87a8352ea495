// SPDX-License-Identifier: GPL-2.0-or-later
/// What a straightforward object-oriented code does, for comparison: two lattices, the
/// populations of a cell side by side, one virtual collision a cell, TRT, periodic.
#pragma once

#include <memory>
#include <vector>

#include "lbm_solver/base/vec3.h"
#include "lbm_solver/collision/two_rates.h"
#include "lbm_solver/viscosity/constant_viscosity.h"

namespace test {

template <class L>
class CellCollision {
 public:
  virtual ~CellCollision() = default;
  virtual void collide(double (&f)[L::Q]) const = 0;
};

template <class L>
class TrtCell final : public CellCollision<L> {
 public:
  explicit TrtCell(double tau) : trt_({.tau = tau}) {}
  void collide(double (&f)[L::Q]) const override { trt_(f, 1.0); }

 private:
  lbm::TwoRates<L, lbm::MagicRate, lbm::ConstantViscosity, lbm::NoForce<L>> trt_;
};

template <class L>
class AosLattice {
 public:
  AosLattice(const lbm::Cell3& cells, double tau)
      : cells_(cells),
        now_(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2]),
        next_(now_.size()),
        collision_(std::make_unique<TrtCell<L>>(tau)) {}

  void step() {
    for (int z = 0; z < cells_[2]; ++z)
      for (int y = 0; y < cells_[1]; ++y)
        for (int x = 0; x < cells_[0]; ++x) {
          Cell f = now_[index(x, y, z)];
          collision_->collide(f.f);
          for (int q = 0; q < L::Q; ++q) {
            const int to_x = wrap(x + L::c[q][0], cells_[0]),
                      to_y = wrap(y + L::c[q][1], cells_[1]);
            const int to_z = L::D == 3 ? wrap(z + L::c[q][2], cells_[2]) : 0;
            next_[index(to_x, to_y, to_z)].f[q] = f.f[q];
          }
        }
    now_.swap(next_);
  }

 private:
  struct Cell {
    double f[L::Q] = {};
  };
  static int wrap(int v, int n) { return v < 0 ? v + n : v >= n ? v - n : v; }
  std::size_t index(int x, int y, int z) const {
    const std::size_t row = L::D == 3 ? static_cast<std::size_t>(z) * cells_[1] + y : y;
    return row * cells_[0] + x;
  }

  lbm::Cell3 cells_;
  std::vector<Cell> now_, next_;
  std::unique_ptr<CellCollision<L>> collision_;
};

}  // namespace test
