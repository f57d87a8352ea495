// SPDX-License-Identifier: MIT
/// What was agreed stays agreed: everything that a solid program sends is held against the fluid's
/// scene when it arrives, whichever program it is.
#pragma once

#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "protocol/wire/clumps.h"
#include "protocol/wire/messages.h"

namespace protocol {

/// Each check names what is wrong, with both values, and the interval that it came with.
/// @throws BadMessage  exit code 2, 3 for what is not finite
class ArrivalCheck {
 public:
  /// @param fluid  the fluid's side of what was agreed
  explicit ArrivalCheck(const Hello& fluid);

  void setting(const Setting& now, std::int64_t interval) const;

  /// @param known  what was told of the particle before; null for one that is new
  /// @param clump  spheres name it as their carrier (ClumpCheck holds it against them)
  void shape(const Shape& shape, const Shape* known, bool clump, std::int64_t interval) const;

  /// A particle that has just come.
  void first_state(const Particle& now, std::int64_t interval) const {
    examine(now, nullptr, interval);
  }
  /// One that was there an interval before. Nearly all of them are finite, in the box, and no
  /// farther than a diameter from where they were, which is seen without a branch.
  void next_state(const State& s, const Shape& shape, const State& before,
                  std::int64_t interval) const {
    if (is_part(shape)) return examine({s, shape}, &before, interval);
    const double diameter = 2.0 * shape.radius;
    double squares = 0.0;
    bool good = true;
    for (int k = 0; k < 3; ++k) {
      const double way = s.x[k] - before.x[k];
      squares += counts_[k] * way * way;
      good = good & (s.x[k] + shape.radius >= lo_[k]) & (s.x[k] - shape.radius <= hi_[k]);
    }
    const double sum = s.v[0] + s.v[1] + s.v[2] + s.omega[0] + s.omega[1] + s.omega[2];
    good = good & (squares <= diameter * diameter) & (sum - sum == 0.0) & in_plane(s, shape);
    if (!good) examine({s, shape}, &before, interval);
  }

  /// The loads that go out may throw particles far in the next intervals.
  /// @param acceleration  that none of them exceeds [m/s²]
  void note_loads(double acceleration) { kicks_[0] = std::exchange(kicks_[1], acceleration); }

  /// @param particles  all of an interval; `is_new` those whose shape came with it
  /// @param is_clump   of which spheres are among them
  void overlaps(std::span<const Particle> particles, std::span<const char> is_new,
                const std::function<bool(std::int64_t)>& is_clump, std::int64_t interval) const;

 private:
  bool inside(const Particle& now) const;
  double fastest(const State& now, const State& before) const;
  bool near(const Particle& now, const State& before) const;
  /// Always in three dimensions; in two, but for round-off in an interval.
  bool in_plane(const State& s, const Shape& shape) const {
    const double turns = std::abs(s.omega[0]) + std::abs(s.omega[1]);
    const double way = (std::abs(s.v[2]) + turns * shape.radius) * interval_;
    return (1.0 - counts_[2]) * way <= kOutOfPlane * shape.radius;
  }
  double moved(const State& now, const State& before, unsigned axis) const;
  void examine(const Particle& now, const State* before, std::int64_t interval) const;
  double agreed_volume(double radius) const;
  void sizes(const Shape& shape, std::int64_t interval) const;
  void inertia(const Shape& shape, bool clump, std::int64_t interval) const;

  static constexpr double kOutOfPlane = 1e-6;  // of a radius, an interval

  Hello fluid_;
  double interval_;    ///< [s]
  double kicks_[2]{};  ///< largest acceleration by a load in the last two intervals [m/s²]
  Vec3 length_{};      ///< of the box [m]
  Vec3 lo_{}, hi_{};   ///< between them lies every particle that touches fluid [m]
  Vec3 counts_{};      ///< 1 for the axes that there are, else 0
};

}  // namespace protocol
