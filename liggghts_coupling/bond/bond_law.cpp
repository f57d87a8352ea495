// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/bond_law.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dem {
namespace {

double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double size(const Vector& a) {
  return std::sqrt(dot(a, a));
}
void add(Vector& a, double factor, const Vector& b) {
  for (int k = 0; k < 3; ++k) a[k] += factor * b[k];
}
void scale(Vector& a, double factor) {
  for (double& v : a) v *= factor;
}

double contact_force(const ContactLaw& law, double overlap) {
  if (overlap <= 0.0) return 0.0;
  return law.normal_stiffness * (law.exponent == 1.0 ? overlap : overlap * std::sqrt(overlap));
}
double contact_energy(const ContactLaw& law, double overlap) {
  return overlap > 0.0 ? contact_force(law, overlap) * overlap / (law.exponent + 1.0) : 0.0;
}
/// dF_n/dδ, which damping refers to.
double contact_stiffness(const ContactLaw& law, double overlap) {
  return law.exponent == 1.0 ? law.normal_stiffness
                             : 1.5 * law.normal_stiffness * std::sqrt(std::max(overlap, 0.0));
}
double spring_energy(double force, double stiffness) {
  return stiffness > 0.0 ? 0.5 * force * force / stiffness : 0.0;
}

/// Turns the stored shear force into the present contact plane at its size.
void turn(Vector& shear, const Vector& normal) {
  const double before = size(shear);
  if (before == 0.0) return;
  add(shear, -dot(shear, normal), normal);
  const double after = size(shear);
  scale(shear, after > 0.0 ? before / after : 0.0);
}

/// Sizes of the parts of a moment across and along the axis of the bond.
struct Moments {
  double bending, twisting;
};
Moments split(const Vector& moment, const Vector& normal) {
  const double along = dot(moment, normal);
  Vector across = moment;
  add(across, -along, normal);
  return {size(across), std::abs(along)};
}

/// Moves the moments of a bond with a section on.
void bend(PairMemory& memory, const BondLaw& bond, const PairMotion& m) {
  const double along = dot(m.turning, m.normal);
  Vector across = m.turning;
  add(across, -along, m.normal);
  add(memory.moment, -bond.normal_stiffness * bond.section.gyration * m.step, across);
  add(memory.moment, -2.0 * bond.shear_stiffness * bond.section.gyration * m.step * along,
      m.normal);
}

/// Adds a dashpot's force along and across, and books what it takes.
void damp(PairResponse& r, const PairMotion& m, double ratio, double normal_stiffness,
          double shear_stiffness, bool slides) {
  const double along = 2.0 * ratio * std::sqrt(normal_stiffness * m.effective_mass);
  const double elastic = r.normal;
  r.normal -= along * m.normal_velocity;
  r.energy.damping += -(r.normal - elastic) * m.normal_velocity * m.step;
  if (slides) return;
  const double across = 2.0 * ratio * std::sqrt(shear_stiffness * m.effective_mass);
  add(r.tangential, -across, m.tangential_velocity);
  r.energy.damping += across * dot(m.tangential_velocity, m.tangential_velocity) * m.step;
}

/// The law of a bond: its springs, or its break. What is left where it breaks by shear is for
/// unbonded().
void bonded(PairResponse& r, PairMemory& now, const ContactLaw& contact, const BondLaw& bond,
            const PairMotion& m) {
  const double normal = bond.normal_stiffness * (m.overlap - now.rest_overlap);
  const double shear = size(now.shear_force);
  const Moments moments = split(now.moment, m.normal);
  const double stored =
      spring_energy(normal, bond.normal_stiffness) + spring_energy(shear, bond.shear_stiffness) +
      spring_energy(moments.bending, bond.normal_stiffness * bond.section.gyration) +
      spring_energy(moments.twisting, 2.0 * bond.shear_stiffness * bond.section.gyration);
  const double per_moment =
      bond.section.radius > 0.0 ? bond.section.radius / bond.section.gyration : 0.0;
  const double pulled = -normal + per_moment * moments.bending;
  const double sheared = shear + 0.5 * per_moment * moments.twisting;
  if (pulled >= bond.tensile_strength) {
    r.broken = Break::Tension;
    r.break_force = pulled;
    r.energy.released = stored;
    now = PairMemory{};
  } else if (sheared >= bond.shear_strength) {
    r.broken = Break::Shear;
    r.break_force = sheared;
    r.energy.stiffness_change =
        stored - contact_energy(contact, m.overlap) - spring_energy(shear, contact.shear_stiffness);
    now.bonded = false;
    now.rest_overlap = 0.0;
    now.moment = {};
  } else {
    r.force = true;
    r.normal = normal;
    r.tangential = now.shear_force;
    r.moment = now.moment;
    r.energy.elastic = stored;
    damp(r, m, contact.damping_ratio, bond.normal_stiffness, bond.shear_stiffness, false);
  }
}

/// The law of surfaces in contact, which slide; apart they forget each other.
void unbonded(PairResponse& r, PairMemory& now, const ContactLaw& contact, const PairMotion& m) {
  const double shear = size(now.shear_force);
  if (m.overlap <= 0.0) {
    r.energy.friction += spring_energy(shear, contact.shear_stiffness);
    now = PairMemory{};
  } else {
    r.force = true;
    r.normal = contact_force(contact, m.overlap);
    const double most = contact.friction * r.normal;
    const bool slides = shear > most;
    if (slides) {
      r.energy.friction += spring_energy(shear, contact.shear_stiffness) -
                           spring_energy(most, contact.shear_stiffness);
      scale(now.shear_force, most / shear);
    }
    r.tangential = now.shear_force;
    r.energy.elastic = contact_energy(contact, m.overlap) +
                       spring_energy(std::min(shear, most), contact.shear_stiffness);
    damp(r, m, contact.damping_ratio, contact_stiffness(contact, m.overlap),
         contact.shear_stiffness, slides);
  }
}

}  // namespace

void make_bond(PairMemory& memory, const ContactLaw& contact, const BondLaw& bond, double overlap) {
  memory.bonded = true;
  memory.rest_overlap = overlap - contact_force(contact, overlap) / bond.normal_stiffness;
}

PairResponse respond(PairMemory& memory, const ContactLaw& contact, const BondLaw& bond,
                     const PairMotion& m, bool advance) {
  PairResponse r;
  PairMemory now = memory;
  if (advance) {
    turn(now.shear_force, m.normal);
    add(now.shear_force, -(now.bonded ? bond.shear_stiffness : contact.shear_stiffness) * m.step,
        m.tangential_velocity);
  }
  if (now.bonded && bond.section.radius > 0.0 && advance) bend(now, bond, m);
  if (now.bonded) bonded(r, now, contact, bond, m);
  if (!now.bonded && r.broken != Break::Tension) unbonded(r, now, contact, m);
  if (advance) memory = now;
  return r;
}

double strength_factor(long a, long b, double spread, unsigned long seed) {
  if (spread == 0.0) return 1.0;
  // SplitMix64 over seed and both ids, the smaller first
  std::uint64_t x = seed;
  for (const long id : {std::min(a, b), std::max(a, b)}) {
    x += 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(id);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    x ^= x >> 31;
  }
  const double unit = static_cast<double>(x >> 11) * 0x1.0p-53;  // [0, 1)
  return 1.0 + spread * (2.0 * unit - 1.0);
}

}  // namespace dem
