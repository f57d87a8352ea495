// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/base/units.h"
#include "lbm_solver/coupling/carrier.h"

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
LightRule light_rule(SolidTerm solid_term, double tau);

/// From the mean load that the lattice puts on a body to the load that the solid is sent.
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
/// Of a clump m_c and m_d are those of the union of its spheres, I_c is a tensor J, and the
/// centroid of the fluid may lie d from its centre (docs/loads.md has the balance):
///   F = … + m_c (dU/dt + dω/dt × d + ω × (ω × d)) - m_d g,
///   T = … + m_c d × dU/dt + J dω/dt + ω × J ω - d × m_d g.
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
/// Where several ranks share the box, each sends the part of F that its cells saw; all that is
/// known of a particle as a whole (inner fluid, buoyancy, virtual mass) is added by its home, the
/// rank that holds its centre.
class LoadCorrection {
 public:
  /// @param flat  two dimensions
  LoadCorrection(const Units& units, const Scene& scene, SolidTerm solid_term, bool flat);

  /// Some particle of the scene may get a virtual mass.
  bool any_light() const { return any_light_; }

  double fluid_mass(double volume) const { return fluid_.density * volume; }
  /// The fluid in the place of a single disc or sphere, and in the cells that it covers.
  DisplacedFluid ball(double radius, double covered_radius) const;

  /// Changes of velocity since the past of a carrier that has one.
  void note_change(const Velocities& now, Carrier& carrier) const;

  /// Adds what the home knows: inner fluid and buoyancy.
  void add_known(const protocol::Particle& p, const Carrier& carrier, double interval,
                 protocol::Load& load) const;
  void add_virtual_mass(const protocol::Particle& p, const Carrier& carrier, double interval,
                        protocol::Load& load) const;

  /// Some side adds buoyancy.
  bool lifts() const { return coupling_.buoyancy != protocol::Buoyancy::None; }
  const Vec3& gravity() const { return fluid_.gravity; }

 private:
  double in_ball(double radius) const;
  double virtual_mass(const protocol::Particle& p, const Carrier& carrier) const;
  void add_inner_fluid(const protocol::Particle& p, const Carrier& carrier, double interval,
                       protocol::Load& load) const;
  void add_uneven(const Vec3& omega, const DisplacedFluid& inside, const Velocities& change,
                  double interval, protocol::Load& load) const;

  FluidScene fluid_;
  CouplingScene coupling_;
  double depth_;
  LightRule light_;
  bool flat_;
  bool any_light_;
};

}  // namespace lbm
