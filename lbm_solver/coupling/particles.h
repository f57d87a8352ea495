// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/base/scene.h"
#include "lbm_solver/field/decomposition.h"
#include "lbm_solver/immersed/body.h"
#include "protocol/wire/session.h"

namespace lbm {

/// How the coupling keeps light particles stable: which get a virtual mass unless the scene says
/// otherwise, and how much of it, over the mass that they displace.
struct LightRule {
  double ratio;         ///< those lighter than this times the fluid
  double virtual_mass;  ///< over the displaced mass
  double mean_weight;   ///< of the last interval in the mean acceleration of their inner fluid
};

/// Of a solid collision. By resistance: below the fluid's density, or below 1.5 times of it where
/// surface cells are nearly transparent (τ below 0.525); proven from 0.1 on. With the other terms
/// below 0.9, or below twice the fluid where it is so viscous that a step carries momentum across a
/// cell (τ above 0.8). Elsewhere those would be harmed: where surface cells are nearly transparent
/// (τ → ½) the fluid answers a virtual mass too late, and they blew up at ρ_s = ρ_f.
LightRule light_rule(const std::string& solid_term, double tau);

/// The solid's particles between wire and lattice: SI states in, bodies in lattice units out,
/// lattice loads in, SI loads out.
///
/// The force that a covered region receives from the lattice includes the change of momentum of the
/// fluid inside it, m_c dU/dt. The solid integrates its own mass only, so that part is given back:
///   F = mean(F_lattice) + m_c (U_k - U_{k-1})/T - m_d g,
///   T = mean(T_lattice) + I_c (ω_k - ω_{k-1})/T,
///   disc:   m_c = rho_f pi R_c² depth,  m_d = rho_f pi R² depth,  I_c = ½ m_c R_c²,
///   sphere: m_c = 4/3 rho_f pi R_c³,    m_d = 4/3 rho_f pi R³,    I_c = 2/5 m_c R_c²,
/// with R the particle's radius and R_c = `hydraulic_ratio` R the radius of the region that it
/// covers on the lattice. Each term takes the radius of that of which it is the momentum:
///
/// - Inner fluid, R_c. Only fluid in covered cells is accelerated with the particle in F_lattice,
///   so no more than that can be given back. With R the ring between the two radii would be given
///   back without ever having been charged: the particle would move as if it had less mass.
/// - Buoyancy, R. The lattice carries no gravity and no hydrostatic pressure, so F_lattice holds
///   nothing of the upthrust, neither of the covered region nor of the ring. The particle displaces
///   the fluid of its whole volume.
/// - Seepage, nothing to add. The ring is fluid on the lattice: the pressure gradient (or the body
///   force) that drives a flow through a bed acts on it as on all other fluid, and since it does
///   not accelerate in the mean, it passes that force on to the covered cells as drag. In steady
///   flow the loads of all particles therefore add up to the drive on the whole volume of the bed,
///   i rho_f |g| of fluid and solid together, for every ratio. An extra pressure force on the ring
///   would count it twice. Together with the buoyancy of the whole particle the bed lifts at
///   i_c = (1-n)(rho_s/rho_f - 1) with n the true porosity (`cases/critical_gradient`).
///   (In a flow that accelerates, or around one particle alone, the ring does not pass everything
///   on: there the particle feels the pressure force of the covered region only.)
/// - Virtual mass, R_c. It stands for the fluid of the lattice that a particle sets in motion.
///
/// A light particle answers a change of load with a large acceleration, which the fluid answers a
/// step later: explicit coupling blows up. With a virtual mass m_v on both sides of its equation of
/// motion, (m_s + m_v) dU/dt = F + G + m_v dU/dt, the right one taken from the last interval, the
/// load to send is
///   F' = (m_s (F + m_v (U_k - U_{k-1})/T) - m_v G) / (m_s + m_v),
/// where G, everything else that acts on the particle, is what the last interval shows:
/// G = m_s (U_k - U_{k-1})/T - F'_{k-1}. Where nothing changes in time, F' = F. The inner fluid's
/// m_c dU/dt of such a particle takes the mean acceleration over some intervals (LightRule):
/// surface cells follow a change more slowly than that term gives it back, which alone blows up
/// below rho_s/rho_f = 0.25. Proven down to 0.1.
///
/// Where several ranks share the box, each knows the particles that touch its cells and sends the
/// part of F that its cells saw; all that is known of a particle as a whole (inner fluid, buoyancy,
/// virtual mass) is added by its home, the rank that holds its centre. The solid adds the parts.
class Particles {
 public:
  /// @param solid_term  that the particles' cells collide by
  Particles(const Units& units, const Scene& scene, const Decomposition& ranks,
            const std::string& solid_term);
  Particles(const Units& units, const Scene& scene, const Domain& domain,
            const std::string& solid_term)
      : Particles(units, scene, Decomposition(domain), solid_term) {}

  /// What the solid told of itself with the particles; on rank 0, and null where it tells nothing.
  const protocol::SolidReport* report() const { return report_ ? &*report_ : nullptr; }
  void tell(const std::optional<protocol::SolidReport>& report) { report_ = report; }

  /// Takes the particles of a new interval of `interval` seconds. One whose shape has another epoch
  /// than before starts anew: nothing that was known of the one with its id holds for it.
  void arrive(std::span<const protocol::Particle> particles, double interval);

  std::size_t size() const { return particles_.size(); }
  std::span<const protocol::Particle> states() const { return particles_; }

  /// Where the bodies are `elapsed` seconds after the interval began, moving on straight.
  std::span<const Body> bodies(double elapsed);

  /// Weight less buoyancy [N] of the particles whose home this rank is.
  Vec3 weight_in_fluid() const;

  /// Masses of the bodies, lattice units.
  std::vector<double> masses() const;

  /// Adds the loads of one fluid step.
  void add(std::span<const BodyLoad> loads);

  /// Mean load over `steps` fluid steps, this rank's part, for the wire. Collective where light
  /// particles are about: then the ranks tell each other the whole loads.
  std::span<const protocol::Load> mean_loads(int steps);

  /// All particles of the box, each once, in the order of their ids.
  struct Everything {
    std::vector<protocol::Particle> particles;
    /// What mean_loads returned last, whole: of this interval, or of the one before while its own
    /// are not known yet; 0 for a particle that has just come.
    std::vector<protocol::Load> loads;
  };
  /// On rank 0; elsewhere empty. Collective.
  Everything gather() const;

  /// What the next interval needs of the last one, for a checkpoint; before `arrive`. Complete on
  /// rank 0; `load` wants it on every rank. Collective.
  Record save() const;
  /// @throws std::invalid_argument where it is no record of particles
  void load(const Record& record);

  double max_speed() const;  ///< [m/s], of centre and rim, of this rank's

 private:
  struct Motion {
    protocol::Vec3 v{}, omega{};
  };
  /// What is kept of a particle from one interval to the next.
  struct Past {
    std::int64_t id = 0, epoch = 0;
    Motion motion;
    protocol::Vec3 force{}, torque{};  ///< as sent, whole where virtual masses are about
    Motion mean_change;                ///< of the last intervals (LightRule)
  };
  /// A vector of a particle that a checkpoint keeps, under a name.
  struct Kept {
    const char* name;
    protocol::Vec3& (*of)(Past&);
  };
  static const std::array<Kept, 6> kKept;
  double covered_radius(std::size_t i) const;    // that the lattice sees, R_c [m]
  double fluid_mass(double radius) const;        // in a disc or sphere of that radius [kg]
  double covered_mass(std::size_t i) const;      // m_c: fluid in covered cells [kg]
  double displaced_mass(std::size_t i) const;    // m_d: fluid in the whole particle's place [kg]
  double inertia_per_mass(std::size_t i) const;  // I_c / m_c [m²]
  bool at_home(std::size_t i) const;             // this rank holds the centre
  protocol::Load hydrodynamic(std::size_t i, int steps) const;
  double virtual_mass(std::size_t i) const;  // over the covered mass
  void add_virtual_mass(std::size_t i, protocol::Load& load) const;
  void share_light();
  std::vector<protocol::Load> latest_loads() const;
  std::vector<Past> present() const;

  Units units_;
  FluidScene fluid_;
  CouplingScene coupling_;
  std::vector<double> hydraulic_ratio_;
  Decomposition ranks_;
  LightRule light_;
  bool flat_;         // two dimensions
  bool light_about_;  // some particle may get a virtual mass
  double interval_ = 0.0;
  std::vector<protocol::Particle> particles_;
  std::vector<Motion> change_;  // of velocities since the interval before; 0 for a new particle
  std::vector<Motion> mean_change_;
  std::vector<Past> past_;
  std::vector<const Past*> before_;  // [particle], null for a new one
  std::vector<Body> bodies_;
  std::vector<BodyLoad> sums_;
  bool loads_known_ = false;                  // of this interval
  std::vector<protocol::Load> loads_;         // this rank's parts
  std::vector<protocol::Load> whole_;         // of all ranks; where virtual masses are about
  std::vector<protocol::Load> loads_before_;  // loads_ of the interval before
  bool whole_now_ = false,
       whole_before_ = false;  // those are from a checkpoint, whole on every rank
  std::optional<protocol::SolidReport> report_;
};

}  // namespace lbm
