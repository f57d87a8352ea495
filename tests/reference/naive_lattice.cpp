// SPDX-License-Identifier: GPL-2.0-or-later
#include "tests/reference/naive_lattice.h"

#include <Eigen/Dense>
#include <cmath>

#include "lbm_solver/lattice/d2q9.h"

namespace test {

using lbm::D2Q9;
using lbm::Side;
using Cell = NaiveLattice::Cell;

NaiveLattice::NaiveLattice(const Domain& domain, const lbm::KernelChoice& choice)
    : domain_(domain),
      choice_(choice),
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
    if (choice_.solid_term == "noble_torczynski")
      omega[i] = noble_torczynski;
    else if (choice_.solid_term == "holdych")
      omega[i] = holdych;
    else if (choice_.solid_term == "superposition")
      omega[i] = solid[i] - f[i] + (1.0 - 1.0 / choice_.parameters.tau) * (f[i] - eq[i]);
    else if (!c.whole)
      omega[i] = choice_.solid_term == "layered_holdych" ? holdych : noble_torczynski;
    else
      omega[i] = c.core ? solid[i] - f[i] : 0.95 * noble_torczynski + 0.05 * (solid[i] - f[i]);
  }
  return omega;
}

namespace {

Vec2 direction(int i) {
  return {D2Q9::c[i][0], D2Q9::c[i][1]};
}

struct Macroscopic {
  double rho = 0.0;
  Vec2 j{0.0, 0.0};
};
Macroscopic macroscopic(const Cell& f) {
  Macroscopic m;
  for (int i = 0; i < 9; ++i) {
    m.rho += f[i];
    m.j += f[i] * direction(i);
  }
  return m;
}

/// Guo's source term.
Cell source(const Vec2& force, const Vec2& u) {
  Cell s;
  for (int i = 0; i < 9; ++i) {
    const double cf = direction(i).dot(force), cu = direction(i).dot(u);
    s[i] = D2Q9::w[i] * (3.0 * cf + 9.0 * cu * cf - 3.0 * u.dot(force));
  }
  return s;
}

/// Q_ab = Σ c_a c_b (f - f^eq) + ½(F_a u_b + u_a F_b)
Eigen::Matrix2d stress(const Cell& f, const Cell& eq, const Vec2& force, const Vec2& u) {
  Eigen::Matrix2d q = 0.5 * (force * u.transpose() + u * force.transpose());
  for (int i = 0; i < 9; ++i) q += (f[i] - eq[i]) * (direction(i) * direction(i).transpose());
  return q;
}

/// Relaxes central moments, each a sum over all directions, and solves for the populations that
/// have the new ones.
Cell central_moments(const Cell& f, double rho, const Vec2& u, const Vec2& force, double omega) {
  Eigen::Matrix<double, 9, 9> to_moments;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int i = 0; i < 9; ++i)
        to_moments(3 * a + b, i) =
            std::pow(direction(i).x() - u.x(), a) * std::pow(direction(i).y() - u.y(), b);
  const Eigen::Matrix<double, 9, 1> k =
      to_moments * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(f.data());
  const auto at = [](int a, int b) { return 3 * a + b; };
  const double difference = (1.0 - omega) * (k[at(2, 0)] - k[at(0, 2)]);
  Eigen::Matrix<double, 9, 1> after = Eigen::Matrix<double, 9, 1>::Zero();
  after[at(0, 0)] = rho;
  after[at(1, 0)] = 0.5 * force.x();
  after[at(0, 1)] = 0.5 * force.y();
  after[at(2, 0)] = rho / 3.0 + 0.5 * difference;
  after[at(0, 2)] = rho / 3.0 - 0.5 * difference;
  after[at(1, 1)] = (1.0 - omega) * k[at(1, 1)];
  after[at(2, 1)] = force.y() / 6.0;
  after[at(1, 2)] = force.x() / 6.0;
  after[at(2, 2)] = rho / 9.0;
  const Eigen::Matrix<double, 9, 1> populations = to_moments.fullPivLu().solve(after);
  Cell out;
  for (int i = 0; i < 9; ++i) out[i] = populations[i];
  return out;
}

/// Hermite sums up to the fourth order, equilibrium and non-equilibrium apart.
Cell recursive_regularised(double rho, const Vec2& u, const Eigen::Matrix2d& q, const Cell& force,
                           double omega) {
  const double x = u.x(), y = u.y();
  const double q3[2] = {y * q(0, 0) + 2 * x * q(0, 1), x * q(1, 1) + 2 * y * q(0, 1)};
  const double q4 = x * x * q(1, 1) + y * y * q(0, 0) + 4 * x * y * q(0, 1);
  Cell out;
  for (int i = 0; i < 9; ++i) {
    const double cx = direction(i).x(), cy = direction(i).y();
    const double hx = cx * cx - 1.0 / 3, hy = cy * cy - 1.0 / 3;
    const auto expansion = [&](double a0, double ax, double ay, double axx, double axy, double ayy,
                               double axxy, double axyy, double axxyy) {
      return D2Q9::w[i] *
             (a0 + 3 * (cx * ax + cy * ay) + 4.5 * (hx * axx + 2 * cx * cy * axy + hy * ayy) +
              13.5 * (hx * cy * axxy + cx * hy * axyy) + 20.25 * hx * hy * axxyy);
    };
    const double eq =
        rho * expansion(1, x, y, x * x, x * y, y * y, x * x * y, x * y * y, x * x * y * y);
    const double neq = expansion(0, 0, 0, q(0, 0), q(0, 1), q(1, 1), q3[0], q3[1], q4);
    out[i] = eq + (1.0 - omega) * neq + 0.5 * force[i];
  }
  return out;
}

}  // namespace

double NaiveLattice::tau(const Cell& f) const {
  const auto& p = choice_.parameters;
  if (choice_.turbulence != "smagorinsky") return p.tau;
  const Vec2 force = choice_.force ? Vec2(p.force_x, p.force_y) : Vec2(0.0, 0.0);
  const Macroscopic m = macroscopic(f);
  const Vec2 u = (m.j + 0.5 * force) / m.rho;
  const Eigen::Matrix2d q = stress(f, naive_equilibrium(m.rho, u), force, u);
  return 0.5 * (p.tau + std::sqrt(p.tau * p.tau + 18.0 * p.smagorinsky * p.smagorinsky *
                                                      std::sqrt(2.0) * q.norm() / m.rho));
}

Cell NaiveLattice::fluid(const Cell& f) const {
  const auto& p = choice_.parameters;
  const Vec2 force = choice_.force ? Vec2(p.force_x, p.force_y) : Vec2(0.0, 0.0);
  const Macroscopic m = macroscopic(f);
  const Vec2 u = (m.j + 0.5 * force) / m.rho;
  const Cell eq = naive_equilibrium(m.rho, u), s = source(force, u);
  const Eigen::Matrix2d q = stress(f, eq, force, u);
  const double tau = this->tau(f);
  if (choice_.collision == "central_moment") return central_moments(f, m.rho, u, force, 1.0 / tau);
  if (choice_.collision == "recursive_regularised")
    return recursive_regularised(m.rho, u, q, s, 1.0 / tau);
  const double odd_tau = choice_.collision == "bgk" ? tau : p.magic / (tau - 0.5) + 0.5;
  Cell out;
  for (int i = 0; i < 9; ++i) {
    const int o = D2Q9::opposite(i);
    const double even = 0.5 * (eq[i] + eq[o] - f[i] - f[o]),
                 odd = 0.5 * (eq[i] - eq[o] - f[i] + f[o]);
    out[i] = f[i] + even / tau + odd / odd_tau + (1.0 - 0.5 / tau) * 0.5 * (s[i] + s[o]) +
             (1.0 - 0.5 / odd_tau) * 0.5 * (s[i] - s[o]);
  }
  return out;
}

Cell NaiveLattice::collided(int x, int y) {
  const Cell& f = cell(x, y);
  const Macroscopic m = macroscopic(f);
  const NaiveCover& c = cover(x, y);
  const Cell eq = naive_equilibrium(m.rho, m.j / m.rho);  // without the body force
  const Cell omega_s = c.weight > 0.0 ? solid_term(f, eq, m.rho, c) : Cell{};
  const Cell post = fluid(f);
  double weight = c.weight;
  if (choice_.turbulence == "smagorinsky")  // B(ε, τ*) of this cell, or B = ε
    weight = lbm::ImmersedWeight{choice_.weight, tau(f)}(weight);
  Cell out;
  Vec2 gain(0.0, 0.0);
  for (int i = 0; i < 9; ++i) {
    out[i] = f[i] + (1.0 - weight) * (post[i] - f[i]) + weight * omega_s[i];
    gain += weight * omega_s[i] * direction(i);
  }
  const auto& p = choice_.parameters;
  const Vec2 body = choice_.force ? Vec2(p.force_x, p.force_y) : Vec2(0.0, 0.0);
  force_[y * domain_.nx + x] = weight * body - gain;
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
