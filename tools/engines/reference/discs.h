// SPDX-License-Identifier: MIT
/// Soft discs with linear springs and dashpots, alone or as equal clumps.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bplbm_solid.h"

/// In the plane: x, y.
using Vec2 = std::array<double, 2>;

struct Box {
  Vec2 low{}, high{};
  std::array<bool, 2> periodic{}, walls{};
};

/// What each of them is, and how they meet.
struct Kind {
  std::vector<bplbm_shape> shapes;  ///< a disc, or a clump and its discs
  std::vector<Vec2> arms;           ///< of these from the centre [m]
  double stiffness = 0.0;           ///< of a contact [N/m]
  double damping = 0.0;             ///< of a contact [N s/m]
  Vec2 gravity{};                   ///< [m/s²]
};

///   F_n = k δ - γ v_n  between discs and with walls, never a pull; velocity Verlet, in which the
///   load of an interval acts in each of its steps, its first half-step included.
class Discs {
 public:
  Discs(const Box& box, const Kind& kind, double step) : box_(box), kind_(kind), step_(step) {}

  /// A disc, or a clump and its discs. @param centre  its id, place and velocity
  void add(const bplbm_state& centre, std::int64_t epoch);
  void remove(std::int64_t id);
  /// Some steps under one load each; what leaves an open box is gone.
  void advance(int steps, std::span<const bplbm_load> loads);

  /// Discs and clumps, without the discs of clumps.
  std::int64_t bodies() const;

  std::vector<bplbm_state> states;
  std::vector<bplbm_shape> shapes;

 private:
  struct Acceleration {
    Vec2 of_place{};    ///< [m/s²]
    double spin = 0.0;  ///< [rad/s²]
  };
  using Accelerations = std::vector<Acceleration>;

  std::vector<std::size_t> movers() const;
  Vec2 way(const bplbm_state& a, const bplbm_state& b) const;
  void kick(const Accelerations& a);
  void drift();
  Accelerations accelerations(std::span<const bplbm_load> loads) const;
  double push(double overlap, double approach) const;
  Vec2 push_of_walls(std::size_t i) const;
  Vec2 push_of_disc(std::size_t i, std::size_t j) const;
  bool put_into_box(bplbm_state& s) const;

  const Box box_;
  const Kind kind_;
  const double step_;  ///< [s]
};
