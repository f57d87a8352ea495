// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "lbm_solver/base/side.h"
#include "lbm_solver/boundary/in_time.h"
#include "lbm_solver/field/cell_pass.h"

namespace lbm {

/// A population that enters a cell along q through a side. After a sweep it holds the cell's own
/// outgoing population, bounced back half-way; a patch replaces it.
struct Link {
  Cell3 cell;  ///< of the rank
  int q;
  std::array<double, 2> at;  ///< where it crosses the side, in cells of the box along its axes
  std::int64_t number;       ///< among all links of the patch, on all ranks
};

/// A part of a side: cells [begin, end) of the box along the other two axes, in their order (x, y,
/// z; in two dimensions the second spans one cell).
struct Opening {
  SideName side = SideName::Left;
  std::array<int, 2> begin{0, 0}, end{0, 1};
  /// The side's neighbours along that axis are periodic and the opening spans it: it has no ends.
  std::array<bool, 2> closed{false, true};

  /// The whole of a side.
  static Opening whole(const Domain& domain, SideName side);
};

/// Links of the rank's cells. A diagonal link that crosses the side exactly at an end of the
/// opening belongs to the wall beside it: edges of slots and corners of the box are no-slip.
std::vector<Link> side_links(const Lattice& lattice, const Domain& domain, const Block& cells,
                             const Opening& opening);

/// What happens on a part of a side instead of no-slip at rest. Acts on a list of links after each
/// sweep.
class Patch {
 public:
  explicit Patch(std::vector<Link> links) : links_(std::move(links)) {}
  virtual ~Patch() = default;

  /// What a patch acts on.
  struct Sweep {
    Populations& f;
    const EsotericPull& stream;
    std::int64_t step;  ///< number of the step just made, for boundaries that change in time
    const std::function<double(const Cell3&)>& solid_fraction;  ///< empty: there are no solids
  };
  virtual void apply(const Sweep& sweep) = 0;

  /// Mass that has entered through this rank's links since the start, lattice units: with it the
  /// mass of an open box is accounted for to round-off.
  double mass_in() const { return mass_in_; }

  /// State of each link that a checkpoint must keep besides the mass; empty: none.
  virtual std::vector<double>& memory() { return no_memory_; }
  const std::vector<Link>& links() const { return links_; }
  void set_mass_in(double mass_in) { mass_in_ = mass_in; }

 protected:
  /// Writes a new value and books its mass.
  void replace(const Population& population, double value) {
    mass_in_ += value - population;
    population = value;
  }

  std::vector<Link> links_;
  double mass_in_ = 0.0;

 private:
  std::vector<double> no_memory_;
};

/// Factor of a velocity along a side, on a grid of its two axes, the first of which runs first:
/// straight between the places, beyond them as at the last.
struct SideProfile {
  std::array<std::vector<double>, 2> places;  ///< rising [cells of the box]; empty: the same
  std::vector<double> factors;

  double factor(const std::array<double, 2>& at) const;
};

/// A wall or inlet of given velocity: f_q = f_-q* + 6 w_q c_q·u(s) [Ladd1994].
class VelocityPatch final : public Patch {
 public:
  /// @param velocity    at the middle, lattice units
  /// @param parabolic   velocity × 4 s (L - s)/L² along each axis of the opening that is not
  /// closed,
  ///                    else uniform
  VelocityPatch(const Lattice& lattice, std::vector<Link> links, const Vec3& velocity,
                bool parabolic, const Opening& opening, const InTime& in_time);
  /// @param velocity  where the profile's factor is 1
  VelocityPatch(const Lattice& lattice, std::vector<Link> links, const Vec3& velocity,
                const SideProfile& profile, const InTime& in_time);
  void apply(const Sweep& sweep) override;
  /// What it added to the population bounced back along a link in the sweep of a step.
  double added(std::size_t link, std::int64_t step) const {
    return in_time_.factor(step) * gain_[link];
  }

 private:
  std::vector<double> gain_;  // [link]
  InTime in_time_;
};

/// What the patches below share: a density on the side, and the next cell inward to take the rest
/// from.
class DensityPatch : public Patch {
 protected:
  /// @param drho  density deviation on the side
  DensityPatch(std::vector<Link> links, SideName side, double drho, const InTime& in_time);
  double drho(std::int64_t step) const { return drho_ * in_time_.factor(step); }
  /// Another density deviation from the coming step on.
  void hold(double drho) { drho_ = drho; }
  /// What arrives along a link from a side where that density is held.
  double at_density(const Sweep& sweep, const Link& link, double drho) const;

  Vec3 inward() const { return {1.0 * inward_[0], 1.0 * inward_[1], 1.0 * inward_[2]}; }
  /// The next cell inward of a link's.
  Cell3 inner(const Link& link) const {
    return {link.cell[0] + inward_[0], link.cell[1] + inward_[1], link.cell[2] + inward_[2]};
  }

 private:
  Cell3 inward_{0, 0, 0};
  double drho_;
  InTime in_time_;
};

/// A given pressure on the side: what arrives is what arrives at the next cell inward, with that
/// cell's equilibrium density exchanged for the boundary's (non-equilibrium extrapolation
/// [GuoZhengShi2002]):
///   f_q = f_q(inner) + f_q^eq(rho, u) - f_q^eq(rho_inner, u),   u of the next cell inward.
/// The side lies half a cell beyond the boundary cell: rho = (2 rho_side + rho_inner)/3 there.
class PressurePatch final : public DensityPatch {
 public:
  PressurePatch(std::vector<Link> links, SideName side, double drho, const InTime& in_time)
      : DensityPatch(std::move(links), side, drho, in_time) {}
  using DensityPatch::hold;
  void apply(const Sweep& sweep) override;
};

/// An open end that lets sound and vortices out: what arrives is carried outward with the speed of
/// sound,
///   ∂f_q/∂t + c_s ∂f_q/∂n = 0   (implicit upwind),
/// while a weak pull brings the mean pressure to its target. Where fluid comes in instead, or a
/// solid lies in the opening, the pressure is held, as by a pressure patch, less ½ rho u² of what
/// comes in: nothing else bounds a backward flow, and what is inside a solid is no sound.
class OutflowPatch final : public DensityPatch {
 public:
  /// @param relax  part of the deviation from drho that is taken away in a step, about c_s / box
  /// length
  OutflowPatch(std::vector<Link> links, SideName side, double drho, double relax);
  void apply(const Sweep& sweep) override;
  std::vector<double>& memory() override { return memory_; }

 private:
  /// How far the pressure is held: 1 from an inflow of C/50 on, or where the solid fraction is 1.
  double held_part(const Sweep& sweep, const Link& link, double inflow) const;

  double relax_;
  std::vector<double> memory_;  // [link] what arrived in the step before
};

/// Pressure jump across a periodic pair of sides [after KimPitsch2007]: populations that enter
/// through the low side gain w_q Δrho, those through the high side lose it. The momentum density is
/// that of the other side, so that no mass is made.
class PressureJumpPatch final : public DensityPatch {
 public:
  /// @param drho  Δrho on the left or bottom side, -Δrho on the other
  PressureJumpPatch(std::vector<Link> links, SideName side, double drho, const InTime& in_time)
      : DensityPatch(std::move(links), side, drho, in_time) {}
  void apply(const Sweep& sweep) override;
};

}  // namespace lbm
