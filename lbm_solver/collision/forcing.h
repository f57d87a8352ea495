// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/parameters.h"
#include "lbm_solver/collision/tensors.h"

namespace lbm {

/// No body force: the velocity is j/rho and nothing is added.
template <class L>
class NoForce {
 public:
  static constexpr bool on = false;
  explicit NoForce(const CollisionParameters&) {}
  /// rho u
  template <class V>
  [[gnu::always_inline]] const Vector<L, V>& momentum(const Vector<L, V>& j) const {
    return j;
  }
};

/// Uniform body force [GuoZhengShi2002]. The velocity takes half of it, rho u = j + F/2, and the
/// populations the source
///   S_i = w_i (3 c_i·F + 9 (c_i·u)(c_i·F) - 3 u·F),   Σ S_i = 0, Σ c_i S_i = F
template <class L>
class GuoForce {
 public:
  static constexpr bool on = true;
  explicit GuoForce(const CollisionParameters& p) : at_{p.force_x, p.force_y, p.force_z} {}
  double operator[](int a) const { return at_[a]; }
  /// The force on a cell, as a vector of V.
  template <class V>
  [[gnu::always_inline]] Vector<L, V> vector() const {
    Vector<L, V> f;
    unroll<L::D>([&](auto a) __attribute__((always_inline)) { f[a] = V(at_[a]); });
    return f;
  }

  template <class V>
  [[gnu::always_inline]] Vector<L, V> momentum(Vector<L, V> j) const {
    unroll<L::D>([&](auto a) __attribute__((always_inline)) { j[a] += V(0.5 * at_[a]); });
    return j;
  }
  template <class V>
  [[gnu::always_inline]] V rest(const Vector<L, V>& u) const {
    return V(-3.0 * L::w[0]) * dot<L>(vector<V>(), u);
  }
  template <int i, class V>
  [[gnu::always_inline]] Halves<V> pair(const Vector<L, V>& u) const {
    const V cf = along<L, i>(vector<V>()), cu = along<L, i>(u), work = dot<L>(vector<V>(), u);
    return {V(L::w[i]) * (V(9.0) * cu * cf - V(3.0) * work), V(3.0 * L::w[i]) * cf};
  }
  /// ½(F_a u_b + u_a F_b), the force's part of Q_ab.
  template <class V>
  [[gnu::always_inline]] void add_to(Symmetric<L, V>& q, const Vector<L, V>& u) const {
    Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      q.template get<a, b>() += V(0.5) * (V(at_[a]) * u[b] + V(at_[b]) * u[a]);
    });
  }

 private:
  double at_[3];
};

}  // namespace lbm
