// SPDX-License-Identifier: GPL-2.0-or-later
#include "tests/reference/naive_lattice.h"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/viscosity/relaxation_table.h"

namespace test {

using lbm::CollisionOperator;
using lbm::opposite;
using lbm::Side;
using Cell = NaiveLattice::Cell;

NaiveLattice::NaiveLattice(const Domain& domain, const lbm::KernelChoice& choice)
    : domain_(domain),
      choice_(choice),
      l_(lbm::lattice(choice.lattice)),
      f_(static_cast<std::size_t>(domain.nx) * domain.ny * domain.nz, Cell{}),
      cover_(f_.size()),
      force_(f_.size()),
      eddies_(f_.size(), 1.0) {
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < (l_.D == 3 ? 3 : 1); ++c)
        if (l_.Q != 19 || a * b * c == 0) powers_.push_back({a, b, c});
  Matrix hermite(l_.Q, l_.Q), moments(l_.Q, l_.Q);
  for (int m = 0; m < l_.Q; ++m)
    for (int i = 0; i < l_.Q; ++i) {
      double polynomial = 1.0, monomial = 1.0;
      for (int a = 0; a < 3; ++a) {
        const double v = l_.c[i][a];
        polynomial *= powers_[m][a] == 0 ? 1.0 : powers_[m][a] == 1 ? v : v * v - 1.0 / 3;
        monomial *= powers_[m][a] == 0 ? 1.0 : powers_[m][a] == 1 ? v : v * v;
      }
      hermite(m, i) = polynomial;
      moments(m, i) = monomial;
    }
  from_hermite_ = hermite.inverse();
  from_moments_ = moments.inverse();
}

Vec3 NaiveLattice::c(int i) const {
  return {1.0 * l_.c[i][0], 1.0 * l_.c[i][1], 1.0 * l_.c[i][2]};
}

Cell NaiveLattice::equilibrium(double rho, const Vec3& u) const {
  Cell eq{};
  for (int i = 0; i < l_.Q; ++i) {
    const double cu = c(i).dot(u);
    eq[i] = l_.w[i] * rho * (1.0 + 3.0 * cu + 4.5 * cu * cu - 1.5 * u.squaredNorm());
  }
  return eq;
}

Cell NaiveLattice::solid_term(const Cell& f, const Cell& eq, double rho,
                              const NaiveCover& c) const {
  const Cell solid = equilibrium(rho, c.velocity);
  Cell omega{};
  for (int i = 0; i < l_.Q; ++i) {
    const int o = opposite(i);
    const double noble_torczynski = f[o] - f[i] + solid[i] - eq[o];
    const double holdych = f[o] - f[i] + solid[i] - solid[o];
    if (c.wall)
      omega[i] = f[o] - f[i];  // full bounce-back
    else if (choice_.solid_term == lbm::SolidTerm::NobleTorczynski)
      omega[i] = noble_torczynski;
    else if (choice_.solid_term == lbm::SolidTerm::Holdych)
      omega[i] = holdych;
    else if (choice_.solid_term == lbm::SolidTerm::Superposition)
      omega[i] = solid[i] - f[i] + (1.0 - 1.0 / choice_.parameters.tau) * (f[i] - eq[i]);
    else if (!c.whole)
      omega[i] = choice_.solid_term == lbm::SolidTerm::LayeredHoldych ? holdych : noble_torczynski;
    else
      omega[i] = c.core ? solid[i] - f[i] : 0.95 * noble_torczynski + 0.05 * (solid[i] - f[i]);
  }
  return omega;
}

NaiveLattice::Macroscopic NaiveLattice::macroscopic(const Cell& f) const {
  Macroscopic m;
  for (int i = 0; i < l_.Q; ++i) {
    m.rho += f[i];
    m.j += f[i] * c(i);
  }
  return m;
}

Vec3 NaiveLattice::body_force() const {
  const auto& p = choice_.parameters;
  return choice_.force ? Vec3(p.force_x, p.force_y, p.force_z) : Vec3();
}

/// Guo's source term.
Cell NaiveLattice::source(const Vec3& u) const {
  const Vec3 force = body_force();
  Cell s{};
  for (int i = 0; i < l_.Q; ++i) {
    const double cf = c(i).dot(force), cu = c(i).dot(u);
    s[i] = l_.w[i] * (3.0 * cf + 9.0 * cu * cf - 3.0 * u.dot(force));
  }
  return s;
}

/// Q_ab = Σ c_a c_b (f - f^eq) + ½(F_a u_b + u_a F_b)
Eigen::Matrix3d NaiveLattice::stress(const Cell& f, const Cell& eq, const Vec3& u) const {
  const Vec3 force = body_force();
  Eigen::Matrix3d q = 0.5 * (force * u.transpose() + u * force.transpose());
  for (int i = 0; i < l_.Q; ++i) q += (f[i] - eq[i]) * (c(i) * c(i).transpose());
  return q;
}

/// Relaxes central moments, each a sum over all directions. The moments about rest follow from the
/// new ones by the binomial theorem, and the populations from these; that they have the new central
/// moments is seen by summing once more.
Cell NaiveLattice::central_moments(const Cell& f, double rho, const Vec3& u, double omega) const {
  const Vec3 force = body_force();
  const int n = l_.Q;
  const auto moments_of = [&](const auto& populations) {
    Vector moments = Vector::Zero(n);
    for (int i = 0; i < n; ++i) {
      double power[3][3];
      for (int a = 0; a < 3; ++a) {
        const double v = l_.c[i][a] - u[a];
        power[a][0] = 1.0, power[a][1] = v, power[a][2] = v * v;
      }
      for (int m = 0; m < n; ++m) {
        const auto& p = powers_[m];
        moments[m] += populations[i] * power[0][p[0]] * power[1][p[1]] * power[2][p[2]];
      }
    }
    return moments;
  };
  const Vector before = moments_of(f);
  Vector after = Vector::Zero(n);
  double trace = 0.0;
  for (int m = 0; m < n; ++m) {
    const auto& p = powers_[m];
    if (p[0] + p[1] + p[2] == 2 && p[0] * p[1] + p[1] * p[2] + p[0] * p[2] == 0) trace += before[m];
  }
  for (int m = 0; m < n; ++m) {
    const auto& p = powers_[m];
    int ones = 0;
    double maxwell = 1.0, push = 0.0;
    for (int a = 0; a < 3; ++a) {
      if (p[a] == 2) maxwell /= 3.0;
      if (p[a] == 1) push = force[a];
      ones += p[a] == 1;
    }
    const int order = p[0] + p[1] + p[2];
    if (ones == 0) after[m] = rho * maxwell;
    if (ones == 1) after[m] = 0.5 * push * maxwell;
    if (order == 2 && ones == 0) after[m] += (1.0 - omega) * (before[m] - trace / l_.D);
    if (order == 2 && ones == 2) after[m] = (1.0 - omega) * before[m];
  }
  Vector about_rest = Vector::Zero(n);  // ∏ c_a^p_a of c_a = (c_a - u_a) + u_a
  for (int m = 0; m < n; ++m)
    for (int k = 0; k < n; ++k) {
      const auto &p = powers_[m], &part = powers_[k];
      if (part[0] > p[0] || part[1] > p[1] || part[2] > p[2]) continue;
      double product = after[k];
      for (int a = 0; a < 3; ++a) {
        if (p[a] - part[a] == 1) product *= p[a] * u[a];
        if (p[a] - part[a] == 2) product *= u[a] * u[a];
      }
      about_rest[m] += product;
    }
  const Vector populations = from_moments_ * about_rest;
  if ((moments_of(populations) - after).cwiseAbs().maxCoeff() > 1e-12)
    throw std::logic_error("populations without the central moments that they were made for");
  Cell out{};
  for (int i = 0; i < n; ++i) out[i] = populations[i];
  return out;
}

/// The populations whose Hermite moments are those of equilibrium and of the non-equilibrium part
/// that Q stands for, each a sum over the pairs of its indices.
Cell NaiveLattice::recursive_regularised(double rho, const Vec3& u, const Eigen::Matrix3d& q,
                                         const Cell& force, double omega) const {
  const int n = l_.Q;
  Vector wanted(n);
  for (int m = 0; m < n; ++m) {
    std::vector<int> indices;  // xxy is {0, 0, 1}
    for (int a = 0; a < 3; ++a) indices.insert(indices.end(), powers_[m][a], a);
    double whole = rho, kept = 0.0;
    for (const int a : indices) whole *= u[a];
    for (std::size_t i = 0; i < indices.size(); ++i)
      for (std::size_t j = i + 1; j < indices.size(); ++j) {
        double product = q(indices[i], indices[j]);
        for (std::size_t k = 0; k < indices.size(); ++k)
          if (k != i && k != j) product *= u[indices[k]];
        kept += product;
      }
    wanted[m] = whole + (1.0 - omega) * kept;
  }
  const Vector populations = from_hermite_ * wanted;
  Cell out{};
  for (int i = 0; i < n; ++i) out[i] = populations[i] + 0.5 * force[i];
  return out;
}

double NaiveLattice::tau(const Cell& f, double eddies, double part) const {
  const auto& p = choice_.parameters;
  if (!choice_.local_viscosity()) return p.tau;
  const Macroscopic m = macroscopic(f);
  const Vec3 u = (m.j + 0.5 * body_force()) / m.rho;
  Eigen::Matrix3d q = stress(f, equilibrium(m.rho, u), u);
  if (p.viscosity_table) {
    q.topLeftCorner(l_.D, l_.D).diagonal().array() -= q.trace() / l_.D;
    if (part == 1.0) return 1.0 / (*p.viscosity_table)(2.0 * q.squaredNorm() / (m.rho * m.rho));
    const double all = std::max(q.squaredNorm(), 1e-100), down = q.diagonal().squaredNorm() / all;
    const double xy = q(0, 1) * q(0, 1), xz = q(0, 2) * q(0, 2), yz = q(1, 2) * q(1, 2);
    const double along = 16.0 * (xy * xz + xy * yz + xz * yz) / (all * all);
    const double corner = part < 0.5 ? std::pow(1.0 - 2.0 * part, 2) : 0.0;
    const double diagonal = part * (1.0 - std::pow(1.0 - part, 4));
    const double others =
        part * (1.0 + 0.5 * along * part * (1.0 - part) - 0.7 * (along + down) * corner);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) q(a, b) /= m.rho * std::max(0.01, a == b ? diagonal : others);
    const auto& table = p.covered_table ? *p.covered_table : *p.viscosity_table;
    return 1.0 / table(2.0 * q.squaredNorm());
  }
  return 0.5 * (p.tau + std::sqrt(p.tau * p.tau + 18.0 * p.smagorinsky * p.smagorinsky * eddies *
                                                      std::sqrt(2.0) * q.norm() / m.rho));
}

Cell NaiveLattice::fluid(const Cell& f, double eddies) const {
  const auto& p = choice_.parameters;
  const Macroscopic m = macroscopic(f);
  const Vec3 u = (m.j + 0.5 * body_force()) / m.rho;
  const Cell eq = equilibrium(m.rho, u), s = choice_.force ? source(u) : Cell{};
  const double tau = this->tau(f, eddies);
  if (choice_.collision == CollisionOperator::CentralMoment)
    return central_moments(f, m.rho, u, 1.0 / tau);
  if (choice_.collision == CollisionOperator::RecursiveRegularised)
    return recursive_regularised(m.rho, u, stress(f, eq, u), s, 1.0 / tau);
  const double odd_tau =
      choice_.collision == CollisionOperator::Bgk ? tau : p.magic / (tau - 0.5) + 0.5;
  Cell out{};
  for (int i = 0; i < l_.Q; ++i) {
    const int o = opposite(i);
    const double even = 0.5 * (eq[i] + eq[o] - f[i] - f[o]),
                 odd = 0.5 * (eq[i] - eq[o] - f[i] + f[o]);
    out[i] = f[i] + even / tau + odd / odd_tau + (1.0 - 0.5 / tau) * 0.5 * (s[i] + s[o]) +
             (1.0 - 0.5 / odd_tau) * 0.5 * (s[i] - s[o]);
  }
  return out;
}

/// Covered cell by resistance, its odd half as a vector of all directions: momentum, ghost and the
/// rest, each relaxed half-way implicitly with the matrix of lbm_solver/docs/resistance.md.
Cell NaiveLattice::resistance(std::size_t cell) {
  const Cell& f = f_[cell];
  const auto& p = choice_.parameters;
  const Macroscopic m = macroscopic(f);
  const NaiveCover& cover = cover_[cell];
  const double t = 1.0 - cover.eps, tau = this->tau(f, eddies_[cell], t), s = tau - 0.5,
               mu = (2.0 - 16.0 / 3 * p.magic) * t * t * t;
  double share = 0.0;  // of momentum that populations along the axes carry
  for (int i = 1; i < l_.Q; ++i)
    if (c(i).squaredNorm() == 1.0) share += 3.0 * l_.w[i] * c(i).x() * c(i).x();
  const double r = std::sqrt(share / (1.0 - share));
  const Vec3 force = body_force(), w = m.j + 0.5 * force - m.rho * cover.velocity;
  Vec3 z;
  const auto psi = [&](int i) { return c(i).squaredNorm() == 1.0 ? 1.0 / r : -r; };
  for (int i = 1; i < l_.Q; ++i) z += psi(i) * f[i] * c(i);
  Eigen::Matrix2d exchange = Eigen::Vector2d(2.0, 2.0).asDiagonal();  // reflection
  double others = 2.0, even_rate = 0.0;
  if (cover.eps < 1.0 - 1e-12) {
    Eigen::Matrix2d n;
    n << 0.75 * t * t / cover.eps - 0.375 * mu, -0.375 * mu / r, -0.375 * mu / r,
        0.375 * (t - 0.5 * mu);
    exchange = (0.5 * Eigen::Matrix2d::Identity() + n / s).inverse();
    others = 1.0 / (0.5 + n(1, 1) / s);
    even_rate = 1.0 / tau;
  } else if (!cover.wall && choice_.solid_term == lbm::SolidTerm::LayeredResistance) {
    const double shell = std::max(1.0, 1.0 / (0.5 + 0.005 / (p.tau - 0.5)));
    others = cover.core ? 1.0 : 2.0;
    exchange = Eigen::Vector2d(cover.core ? 1.0 : shell, others).asDiagonal();
  }
  const bool at_surface = even_rate > 0.0;
  const Vec3 lost = exchange(0, 0) * w + exchange(0, 1) * z;
  const Vec3 ghost_lost = exchange(1, 0) * w + exchange(1, 1) * z;
  const Vec3 u = (at_surface ? m.j + 0.5 * force - 0.5 * lost : m.j) / m.rho;
  const Cell eq = equilibrium(m.rho, u), solid = equilibrium(m.rho, cover.velocity);
  const Cell push = choice_.force ? source(u) : Cell{};
  const bool reflects = cover.wall || choice_.solid_term == lbm::SolidTerm::Resistance;
  Cell out{};
  for (int i = 0; i < l_.Q; ++i) {
    const int o = opposite(i);
    const double even = 0.5 * (f[i] + f[o]), odd = 0.5 * (f[i] - f[o]);
    const double even_fluid = 0.5 * (eq[i] + eq[o]), even_solid = 0.5 * (solid[i] + solid[o]);
    const double own = 3.0 * l_.w[i] * c(i).dot(m.j + psi(i) * z);  // momentum's and ghost's part
    double after = even;
    if (at_surface)
      after +=
          even_rate * (even_fluid - even) + (1.0 - 0.5 * even_rate) * 0.5 * (push[i] + push[o]);
    else if (!reflects)
      after += (cover.core ? 1.0 : std::min(1.0, 0.015 / (p.tau - 0.5))) * (even_solid - even);
    out[i] = after + (1.0 - others) * (odd - own) + own +
             3.0 * l_.w[i] * c(i).dot(force - lost - psi(i) * ghost_lost);
  }
  force_[cell] = lost;
  return out;
}

Cell NaiveLattice::collided(std::size_t cell) {
  const Cell& f = f_[cell];
  if (cover_[cell].eps > 0.0 && lbm::by_resistance(choice_.solid_term)) return resistance(cell);
  const Macroscopic m = macroscopic(f);
  const NaiveCover& cover = cover_[cell];
  const Cell eq = equilibrium(m.rho, m.j / m.rho);  // without the body force
  const Cell omega_s = cover.eps > 0.0 ? solid_term(f, eq, m.rho, cover) : Cell{};
  const Cell post = fluid(f, eddies_[cell]);
  double weight = cover.eps;
  if (choice_.weight != lbm::WeightRule::Fraction) {
    const bool les = choice_.local_viscosity();
    const double s = (les ? tau(f, eddies_[cell], 1.0 - cover.eps) : choice_.parameters.tau) - 0.5;
    const double c = choice_.weight == lbm::WeightRule::Balanced ? 1.0 - 0.5 * s : 1.0;
    weight = cover.eps * s / ((1.0 - cover.eps) * c + s);
  }
  Cell out{};
  Vec3 gain;
  for (int i = 0; i < l_.Q; ++i) {
    out[i] = f[i] + (1.0 - weight) * (post[i] - f[i]) + weight * omega_s[i];
    gain += weight * omega_s[i] * c(i);
  }
  force_[cell] = weight * body_force() - gain;
  return out;
}

void NaiveLattice::step() {
  std::vector<Cell> next(f_.size());
  for (int z = 0; z < domain_.nz; ++z)
    for (int y = 0; y < domain_.ny; ++y)
      for (int x = 0; x < domain_.nx; ++x) {
        const Cell f = collided(index(x, y, z));
        for (int i = 0; i < l_.Q; ++i) {
          int to[3] = {x + l_.c[i][0], y + l_.c[i][1], z + l_.c[i][2]};
          bool back = false;
          for (int a = 0; a < 3; ++a) {
            const int n = domain_.cells()[a];
            const bool out = to[a] < 0 || to[a] >= n;
            back = back || (out && domain_.sides()[a] == Side::Wall);
            to[a] = (to[a] + n) % n;
          }
          if (back)
            next[index(x, y, z)][opposite(i)] = f[i];
          else
            next[index(to[0], to[1], to[2])][i] = f[i];
        }
      }
  f_.swap(next);
}

}  // namespace test
