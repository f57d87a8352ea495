// SPDX-License-Identifier: GPL-2.0-or-later
/// What a straightforward object-oriented code does, for comparison: two lattices, the nine
/// populations of a cell side by side, one virtual collision a cell, TRT, periodic.
#pragma once

#include <memory>
#include <vector>

#include "lbm_solver/collision/two_rates.h"

namespace test {

class CellCollision {
 public:
  virtual ~CellCollision() = default;
  virtual void collide(double (&f)[9]) const = 0;
};

class TrtCell final : public CellCollision {
 public:
  explicit TrtCell(double tau) : trt_({.tau = tau}) {}
  void collide(double (&f)[9]) const override { trt_(f); }

 private:
  lbm::TwoRates<lbm::MagicRate, lbm::Laminar, lbm::NoForce> trt_;
};

class AosLattice {
 public:
  AosLattice(int nx, int ny, double tau)
      : nx_(nx),
        ny_(ny),
        now_(static_cast<std::size_t>(nx) * ny),
        next_(now_.size()),
        collision_(std::make_unique<TrtCell>(tau)) {}

  void step() {
    for (int y = 0; y < ny_; ++y)
      for (int x = 0; x < nx_; ++x) {
        Cell f = now_[static_cast<std::size_t>(y) * nx_ + x];
        collision_->collide(f.f);
        for (int q = 0; q < 9; ++q) {
          const int to_x = wrap(x + lbm::D2Q9::c[q][0], nx_),
                    to_y = wrap(y + lbm::D2Q9::c[q][1], ny_);
          next_[static_cast<std::size_t>(to_y) * nx_ + to_x].f[q] = f.f[q];
        }
      }
    now_.swap(next_);
  }

 private:
  struct Cell {
    double f[9] = {};
  };
  static int wrap(int a, int n) { return a < 0 ? a + n : a >= n ? a - n : a; }
  int nx_, ny_;
  std::vector<Cell> now_, next_;
  std::unique_ptr<CellCollision> collision_;
};

}  // namespace test
