// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/base/scene.h"
#include "lbm_solver/coupling/carrier.h"
#include "lbm_solver/coupling/clump_shapes.h"
#include "lbm_solver/coupling/load_correction.h"
#include "lbm_solver/coupling/particle_gather.h"
#include "lbm_solver/field/decomposition.h"
#include "protocol/wire/session.h"

namespace lbm {

/// The solid's particles between wire and lattice: SI states in, bodies in lattice units out,
/// lattice loads in, SI loads out (LoadCorrection). A particle of the wire is a carrier, which has
/// a mass and feels a load, or one sphere of a clump, which covers cells for its carrier. A grain
/// is both. During an interval a carrier moves on straight and turns at its angular velocity; its
/// spheres go with it.
///
/// Where several ranks share the box, each knows the particles that touch its cells, of a clump the
/// carrier and all spheres, and sends the part of the load that its cells saw. The solid adds the
/// parts.
class Particles {
 public:
  /// @param solid_term  that the particles' cells collide by
  Particles(const Units& units, const Scene& scene, const Decomposition& ranks,
            SolidTerm solid_term);
  Particles(const Units& units, const Scene& scene, const Domain& domain, SolidTerm solid_term)
      : Particles(units, scene, Decomposition(domain), solid_term) {}

  /// What the solid told of itself with the particles; on rank 0, and null where it tells nothing.
  const protocol::SolidReport* report() const { return report_ ? &*report_ : nullptr; }
  void tell(const std::optional<protocol::SolidReport>& report) { report_ = report; }

  /// Takes the particles of a new interval of `interval` seconds. One whose shape has another epoch
  /// than before starts anew: nothing that was known of the one with its id holds for it.
  void arrive(std::span<const protocol::Particle> particles, double interval);

  std::size_t size() const { return particles_.size(); }
  std::span<const protocol::Particle> states() const { return particles_; }
  /// Some of them are clumps.
  bool has_clumps() const { return has_clumps_; }

  /// Where the spheres are `elapsed` seconds after the interval began.
  std::span<const Body> bodies(double elapsed);

  /// How many carriers (spheres and clumps) have their home on this rank.
  std::int64_t carriers_at_home() const;
  /// Weight less buoyancy [N] of the carriers whose home this rank is.
  Vec3 weight_in_fluid() const;

  /// Masses of the bodies, lattice units: what answers a push at a sphere of a clump is at least
  /// m / (1 + m arm² / I).
  std::vector<double> masses() const;

  /// Adds the loads of one fluid step on the bodies, where they stood last.
  void add(std::span<const BodyLoad> loads);

  /// Mean load over `steps` fluid steps, this rank's part, for the wire: of a carrier, and zero for
  /// the spheres of a clump. Collective where light particles are about: then the ranks tell each
  /// other the whole loads.
  std::span<const protocol::Load> mean_loads(int steps);

  /// All particles of the box, each once, in the order of their ids, and what mean_loads returned
  /// last, whole: of this interval, or of the one before while its own are not known yet; 0 for a
  /// particle that has just come.
  using Everything = GatheredParticles;
  /// On rank 0; elsewhere empty. Collective.
  Everything gather() const;

  /// What the next interval needs of the last one, for a checkpoint; before `arrive`. Complete on
  /// rank 0; `load` wants it on every rank. Collective.
  Record save() const;
  /// @throws std::invalid_argument where it is no record of particles
  void load(const Record& record);

  double max_speed() const;  ///< [m/s], of centre and rim, of this rank's

 private:
  bool at_home(const protocol::Particle& particle) const;
  double covered_radius(const protocol::Shape& shape) const;
  void find_carriers();
  void add_sphere(std::size_t particle, std::size_t carrier);
  void find_inner_fluid();
  void find_past();
  protocol::Load mean_load(const Carrier& carrier, int steps) const;
  void share_loads();
  std::vector<protocol::Load> latest_loads() const;
  std::vector<Past> present() const;

  Units units_;
  std::vector<double> hydraulic_ratio_;
  Decomposition ranks_;
  bool flat_;  // two dimensions
  LoadCorrection correction_;
  ClumpShapes clump_shapes_;
  double interval_ = 0.0;
  std::vector<protocol::Particle> particles_;
  std::vector<Carrier> carriers_;        // in the order of the particles
  std::vector<Sphere> spheres_;          // likewise
  std::vector<std::size_t> carrier_of_;  // [particle]; kNone: a sphere of a clump
  bool has_clumps_ = false;
  std::vector<Past> past_;
  std::vector<Body> bodies_;                  // [sphere]
  std::vector<Vec3> arms_;                    // [sphere] as the bodies stand, in cells
  bool loads_known_ = false;                  // of this interval
  std::vector<protocol::Load> loads_;         // [particle] this rank's parts
  std::vector<protocol::Load> whole_;         // of all ranks; where virtual masses are about
  std::vector<protocol::Load> loads_before_;  // loads_ of the interval before
  bool whole_now_ = false,
       whole_before_ = false;  // those are from a checkpoint, whole on every rank
  std::optional<protocol::SolidReport> report_;
};

}  // namespace lbm
