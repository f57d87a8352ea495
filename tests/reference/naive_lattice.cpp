// SPDX-License-Identifier: GPL-2.0-or-later
#include "tests/reference/naive_lattice.h"

#include "lbm_solver/lattice/d2q9.h"

namespace test {

using lbm::D2Q9;
using lbm::Side;
using Cell = NaiveLattice::Cell;

NaiveLattice::NaiveLattice(const Domain& domain, const std::string& collision, double tau,
                           double magic, const std::string& term)
    : domain_(domain),
      collision_(collision),
      term_(term),
      tau_(tau),
      magic_(magic),
      f_(domain.nx * domain.ny),
      cover_(f_.size()),
      force_(f_.size(), Vec2(0.0, 0.0)) {}

Cell naive_equilibrium(double rho, const Vec2& u) {
  Cell eq;
  for (int i = 0; i < 9; ++i) {
    const double cu = D2Q9::c[i][0] * u.x() + D2Q9::c[i][1] * u.y();
    eq[i] = D2Q9::w[i] * rho * (1.0 + 3.0 * cu + 4.5 * cu * cu - 1.5 * u.squaredNorm());
  }
  return eq;
}

Cell NaiveLattice::solid_term(const Cell& f, const Cell& eq, double rho,
                              const NaiveCover& c) const {
  const Cell solid = naive_equilibrium(rho, c.velocity);
  Cell omega;
  for (int i = 0; i < 9; ++i) {
    const int o = D2Q9::opposite(i);
    const double noble_torczynski = f[o] - f[i] + solid[i] - eq[o];
    const double holdych = f[o] - f[i] + solid[i] - solid[o];
    if (term_ == "noble_torczynski")
      omega[i] = noble_torczynski;
    else if (term_ == "holdych")
      omega[i] = holdych;
    else
      omega[i] = !c.whole ? holdych : c.core ? solid[i] - f[i] : noble_torczynski;
  }
  return omega;
}

Cell NaiveLattice::collided(int x, int y) {
  const Cell& f = cell(x, y);
  double rho = 0.0;
  Vec2 j(0.0, 0.0);
  for (int i = 0; i < 9; ++i) {
    rho += f[i];
    j += f[i] * Vec2(D2Q9::c[i][0], D2Q9::c[i][1]);
  }
  const Cell eq = naive_equilibrium(rho, j / rho);
  const double even_rate = 1.0 / tau_;
  const double odd_rate = collision_ == "bgk" ? even_rate : 1.0 / (magic_ / (tau_ - 0.5) + 0.5);
  const NaiveCover& c = cover(x, y);
  const Cell omega_s = c.weight > 0.0 ? solid_term(f, eq, rho, c) : Cell{};
  Cell out;
  Vec2 gain(0.0, 0.0);
  for (int i = 0; i < 9; ++i) {
    const int o = D2Q9::opposite(i);
    const double even = 0.5 * (f[i] + f[o]) - 0.5 * (eq[i] + eq[o]);
    const double odd = 0.5 * (f[i] - f[o]) - 0.5 * (eq[i] - eq[o]);
    out[i] = f[i] - (1.0 - c.weight) * (even_rate * even + odd_rate * odd) + c.weight * omega_s[i];
    gain += c.weight * omega_s[i] * Vec2(D2Q9::c[i][0], D2Q9::c[i][1]);
  }
  force_[y * domain_.nx + x] = -gain;
  return out;
}

void NaiveLattice::stream(int x, int y, const Cell& f, std::vector<Cell>& next) const {
  for (int i = 0; i < 9; ++i) {
    int to_x = x + D2Q9::c[i][0], to_y = y + D2Q9::c[i][1];
    const bool out_x = to_x < 0 || to_x >= domain_.nx, out_y = to_y < 0 || to_y >= domain_.ny;
    if ((out_x && domain_.x == Side::Wall) || (out_y && domain_.y == Side::Wall)) {
      next[y * domain_.nx + x][D2Q9::opposite(i)] = f[i];
      continue;
    }
    to_x = (to_x + domain_.nx) % domain_.nx;
    to_y = (to_y + domain_.ny) % domain_.ny;
    next[to_y * domain_.nx + to_x][i] = f[i];
  }
}

void NaiveLattice::step() {
  std::vector<Cell> next(f_.size());
  for (int y = 0; y < domain_.ny; ++y)
    for (int x = 0; x < domain_.nx; ++x) stream(x, y, collided(x, y), next);
  f_.swap(next);
}

}  // namespace test
