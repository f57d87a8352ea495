// SPDX-License-Identifier: GPL-2.0-or-later
/// The contact bond of the bonded particle model, and the contact law that is left when it has
/// broken, as a pure function of one pair: no LIGGGHTS here.
#pragma once

#include <array>

namespace dem {

using Vector = std::array<double, 3>;

/// Contact of unbonded surfaces, SI units.
struct ContactLaw {
  double normal_stiffness = 0.0;  ///< K_n in F_n = K_n δ^m [N/m^m]
  double exponent = 1.0;          ///< m: 1 linear, 3/2 Hertz
  double shear_stiffness = 0.0;   ///< K_t [N/m]
  double friction = 0.0;          ///< Coulomb's μ
  double damping_ratio = 0.0;     ///< ξ of a dashpot 2ξ√(k m_eff), normal and tangential
};

/// Cross-section of a bond that carries moments too (a parallel bond), so that bending and twisting
/// stretch its fibres. With A its area and I its second moment: a rectangle of half-height R̄ in two
/// dimensions, I/A = R̄²/3; a disc of radius R̄ in three, I/A = R̄²/4.
struct BondSection {
  double radius = 0.0;    ///< R̄ [m]; 0: no moments
  double gyration = 0.0;  ///< I/A [m²]
  static BondSection of(double radius, bool three_dimensional) {
    return {radius, radius * radius / (three_dimensional ? 4.0 : 3.0)};
  }
};

/// Springs at the contact point, no slip: one along, one across; with a section one for each
/// moment.
struct BondLaw {
  double normal_stiffness = 0.0;  ///< K_n^b, tension and compression [N/m]
  double shear_stiffness = 0.0;   ///< K_t^b [N/m]
  double tensile_strength = 0.0;  ///< F_bn [N]
  double shear_strength = 0.0;    ///< F_bs [N]
  BondSection section;
};

/// What a pair remembers from step to step.
struct PairMemory {
  bool bonded = false;
  double rest_overlap = 0.0;  ///< of the bond: F_n = K_n^b (δ - rest_overlap) [m]
  Vector shear_force{};       ///< on particle i, without damping [N]
  Vector moment{};            ///< on particle i, of a bond with a section [N m]
};

/// Where a pair is and how it moves.
struct PairMotion {
  double overlap = 0.0;          ///< δ = R_i + R_j - distance; negative in a gap [m]
  Vector normal{};               ///< unit, from j to i
  double normal_velocity = 0.0;  ///< of i against j along the normal; positive: parting [m/s]
  Vector tangential_velocity{};  ///< of i's surface against j's at the contact point [m/s]
  Vector turning{};              ///< ω_i - ω_j, for moments [rad/s]
  double effective_mass = 0.0;   ///< m_i m_j/(m_i + m_j) [kg]
  double step = 0.0;             ///< [s]
};

enum class Break { None, Tension, Shear };

/// Where energy went in a step [J].
struct EnergyFlow {
  double elastic = 0.0;           ///< stored at the end of the step
  double friction = 0.0;          ///< to sliding
  double damping = 0.0;           ///< to dashpots
  double released = 0.0;          ///< stored in a bond that broke by tension
  double stiffness_change = 0.0;  ///< stored in a bond that broke by shear, less what the contact
                                  ///< stores at the same place
};

struct PairResponse {
  bool force = false;   ///< the pair still acts; false: it parted, its memory is empty
  double normal = 0.0;  ///< force on i along the normal, positive pushes apart [N]
  Vector tangential{};  ///< force on i [N]
  Vector moment{};      ///< on i, the opposite on j [N m]
  Break broken = Break::None;
  double break_force = 0.0;  ///< that broke it [N]
  EnergyFlow energy;
};

/// Makes a bond of a pair as it is. Nothing jumps: the bond starts with the force of the contact,
/// K_n^b (δ - rest) = K_n δ^m, and keeps its shear force; across a gap it starts without force.
void make_bond(PairMemory& memory, const ContactLaw& contact, const BondLaw& bond, double overlap);

/// Forces of a pair, and its memory moved on by a step [Potyondy and Cundall 2004; paper A Eqs 3-6
/// with Eq 6 corrected].
///   shear        F_t ← F_t - K_t v_t Δt, turned with the contact plane
///   bonded       F_n = K_n^b (δ - rest). At F_n ≤ -F_bn it breaks by tension: both forces vanish.
///                At |F_t| ≥ F_bs it breaks by shear: the contact law goes on with this shear
///                force.
///   with a section (parallel bond): bending M_b ← M_b - K_n^b I/A ω_b Δt, twisting M_t ← M_t -
///                2 K_t^b I/A ω_t Δt; what breaks is the most stretched fibre: -F_n + |M_b| R̄A/I ≥
///                F_bn, |F_t| + |M_t| R̄A/2I ≥ F_bs
///   contact      F_n = K_n δ^m for δ > 0, |F_t| ≤ μ F_n
/// @param advance  false: forces of the present state only, nothing moves on (a second look at the
///                 same step)
PairResponse respond(PairMemory& memory, const ContactLaw& contact, const BondLaw& bond,
                     const PairMotion& motion, bool advance);

/// Factor on the strengths of the bond between two particles: uniform in [1 - spread, 1 + spread],
/// the same in any order, on any rank and after a restart.
double strength_factor(long a, long b, double spread, unsigned long seed);

}  // namespace dem
