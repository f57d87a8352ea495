// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/script_clumps.h"

#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <fix_property_atom.h>
#include <fmt/format.h>
#include <modify.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "liggghts_coupling/host/script_checks.h"
#include "protocol/wire/errors.h"
#include "protocol/wire/names.h"
#include "protocol/wire/overlap.h"

namespace dem {
namespace {

using LAMMPS_NS::FixRigid;
using protocol::EngineClump;
using protocol::Vec3;

/// What a fix rigid knows of its bodies is protected, and `extract` gives little of it; a class
/// derived from it may name the members.
struct Inside : FixRigid {
  static constexpr auto count = &Inside::nbody;
  static constexpr auto body_of = &Inside::body;
  static constexpr auto spheres = &Inside::nrigid;
  static constexpr auto mass = &Inside::masstotal;
  static constexpr auto place = &Inside::xcm;
  static constexpr auto velocity = &Inside::vcm;
  static constexpr auto spin = &Inside::omega;
  static constexpr auto principal = &Inside::inertia;
  static constexpr auto axis_x = &Inside::ex_space;
  static constexpr auto axis_y = &Inside::ey_space;
  static constexpr auto axis_z = &Inside::ez_space;
  static constexpr auto force = &Inside::fcm;
  static constexpr auto turn = &Inside::torque;
};

/// Clumps of a fix rigid keep apart from those of fix multisphere and of each other.
std::int64_t multisphere_id(int tag) {
  return protocol::clump_id(0, tag);
}
std::int64_t rigid_id(std::size_t number, int body) {
  return protocol::clump_id(static_cast<std::int64_t>(number) + 1, body + 1);
}

Vec3 vector(const double* v) {
  return {v[0], v[1], v[2]};
}

void add(double* sum, const Vec3& part) {
  for (int k = 0; k < 3; ++k) sum[k] += part[k];
}

}  // namespace

void ScriptClumps::find() {
  multisphere_ = nullptr;
  rigid_.clear();
  set_up_before_.clear();
  bool passed = false;  // fix lbm/couple
  for (int i = 0; i < modify->nfix; ++i) {
    LAMMPS_NS::Fix& fix = *modify->fix[i];
    if (std::string(fix.style) == "multisphere")
      multisphere_ = dynamic_cast<LAMMPS_NS::FixMultisphere*>(&fix);
    passed = passed || std::string(fix.style) == "lbm/couple";
    auto* const rigid = dynamic_cast<FixRigid*>(&fix);
    if (!rigid) continue;
    int overlap = ScriptChecks(lmp).joins_overlapping(fix.groupbit) ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &overlap, 1, MPI_INT, MPI_MAX, world);
    if (!overlap) continue;
    rigid_.push_back(rigid);
    set_up_before_.push_back(!passed);
  }
}

const std::int64_t* ScriptClumps::carriers() const {
  if (!any()) return nullptr;
  carriers_.assign(static_cast<std::size_t>(std::max(1, atom->nlocal)), protocol::kItself);
  const double* const taken_out = multisphere_ && multisphere_->fix_delflag()
                                      ? multisphere_->fix_delflag()->vector_atom
                                      : nullptr;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (multisphere_ && multisphere_->belongs_to(i) >= 0)
      carriers_[i] = multisphere_id(multisphere_->belongs_to(i));
    else if (taken_out && taken_out[i] != 0.0)
      carriers_[i] = kGone;
    for (std::size_t n = 0; n < rigid_.size(); ++n)
      if (const int body = (rigid_[n]->*Inside::body_of)[i]; body >= 0)
        carriers_[i] = rigid_id(n, body);
  }
  return carriers_.data();
}

bool ScriptClumps::in_part(int groupbit) const {
  int found[2] = {0, 0};  // spheres of clumps outside of the group, in it
  const std::int64_t* const carrier = carriers();
  for (int i = 0; carrier && i < atom->nlocal; ++i)
    if (carrier[i] != protocol::kItself) found[(atom->mask[i] & groupbit) != 0] = 1;
  MPI_Allreduce(MPI_IN_PLACE, found, 2, MPI_INT, MPI_MAX, world);
  return found[0] == 1 && found[1] == 1;
}

void ScriptClumps::refuse_wrong_weight() const {
  if (modify->n_fixes_style("gravity") == 0) return;
  for (std::size_t n = 0; n < rigid_.size(); ++n) expect_weight_of(n);
}

/// The weight is wrong as the mass is, and pulls at another place than the centre.
void ScriptClumps::expect_weight_of(std::size_t number) const {
  constexpr double kOff = 1e-3;  // of the mass, and of the clump's reach
  const FixRigid& fix = *rigid_[number];
  const int bodies = (fix.*Inside::count);
  std::vector<double> sums(4 * static_cast<std::size_t>(bodies), 0.0), reach(bodies, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int b = (fix.*Inside::body_of)[i];
    if (b < 0) continue;
    double arm[3];
    for (int k = 0; k < 3; ++k) arm[k] = atom->x[i][k] - (fix.*Inside::place)[b][k];
    domain->minimum_image(arm);
    sums[4 * b] += atom->rmass[i];
    for (int k = 0; k < 3; ++k) sums[4 * b + 1 + k] += atom->rmass[i] * arm[k];
    reach[b] = std::max(reach[b], std::hypot(arm[0], arm[1], arm[2]) + atom->radius[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 4 * bodies, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(MPI_IN_PLACE, reach.data(), bodies, MPI_DOUBLE, MPI_MAX, world);
  for (int b = 0; b < bodies; ++b) {
    const double mass = (fix.*Inside::mass)[b], *const sum = &sums[4 * b];
    const double apart = std::hypot(sum[1], sum[2], sum[3]) / sum[0];
    if (std::abs(sum[0] - mass) <= kOff * mass && apart <= kOff * reach[b]) continue;
    throw protocol::ProgramError(
        fmt::format("fix lbm/couple: fix gravity weighs the spheres of fix {} rigid, not its "
                    "bodies: those of body {} have {:.6g} kg together, the body {:.6g} kg, and "
                    "their centres of mass are {:.3g} m apart; give the spheres densities with "
                    "which both agree",
                    fix.id, b + 1, sum[0], mass, apart),
        protocol::kBadInput);
  }
}

std::vector<EngineClump> ScriptClumps::clumps() const {
  std::vector<EngineClump> clumps;
  if (multisphere_) add_multisphere(clumps);
  if (comm->me == 0)
    for (std::size_t n = 0; n < rigid_.size(); ++n) add_rigid(n, clumps);
  return clumps;
}

void ScriptClumps::add_multisphere(std::vector<EngineClump>& clumps) const {
  LAMMPS_NS::Multisphere& data = multisphere_->data();
  double** const inertia = data.extract_double_vector("inertia");
  for (int b = 0; b < data.n_body(); ++b) {
    EngineClump& clump = clumps.emplace_back();
    clump.id = multisphere_id(data.tag(b));
    clump.type = data.atomtype(b);
    data.xcm(clump.x.data(), b);
    data.vcm(clump.v.data(), b);
    data.omega(clump.omega.data(), b);
    clump.mass = data.mass(b);
    clump.inertia = (inertia[b][0] + inertia[b][1] + inertia[b][2]) / 3.0;
    clump.volume = data.volume(b);
    clump.spheres = data.nrigid(b);
  }
}

void ScriptClumps::add_rigid(std::size_t number, std::vector<EngineClump>& clumps) const {
  const FixRigid& fix = *rigid_[number];
  for (int b = 0; b < (fix.*Inside::count); ++b) {
    EngineClump& clump = clumps.emplace_back();
    clump.id = rigid_id(number, b);
    clump.x = vector((fix.*Inside::place)[b]);
    clump.v = vector((fix.*Inside::velocity)[b]);
    clump.omega = vector((fix.*Inside::spin)[b]);
    clump.mass = (fix.*Inside::mass)[b];
    clump.spheres = (fix.*Inside::spheres)[b];
    const double* principal = (fix.*Inside::principal)[b];
    const double z[] = {(fix.*Inside::axis_x)[b][2], (fix.*Inside::axis_y)[b][2],
                        (fix.*Inside::axis_z)[b][2]};
    for (int k = 0; k < 3; ++k)
      clump.inertia += principal[k] * (domain->dimension == 2 ? z[k] * z[k] : 1.0 / 3.0);
  }
}

/// What is added to a body of fix multisphere between its pre_force and its final_integrate, it
/// takes together with the forces on its spheres.
void ScriptClumps::push(std::span<const protocol::Load> loads, protocol::Moment when) {
  const auto load_of = [&](std::int64_t id) -> const protocol::Load* {
    const auto at = std::lower_bound(
        loads.begin(), loads.end(), id,
        [](const protocol::Load& load, std::int64_t wanted) { return load.id < wanted; });
    return at == loads.end() || at->id != id ? nullptr : &*at;
  };
  if (multisphere_) {
    LAMMPS_NS::Multisphere& data = multisphere_->data();
    double** const force = data.extract_double_vector("fcm");
    double** const torque = data.extract_double_vector("torque");
    for (int b = 0; b < data.n_body(); ++b)
      if (const protocol::Load* load = load_of(multisphere_id(data.tag(b)))) {
        add(force[b], load->force);
        add(torque[b], load->torque);
      }
  }
  using protocol::Moment;
  for (std::size_t n = 0; n < rigid_.size(); ++n)
    push_rigid(n, loads, when == Moment::End || (when == Moment::SetUp && set_up_before_[n]));
}

/// A fix rigid adds up the forces on its spheres: the load of a body goes in equal parts to those,
/// each with the torque that makes the sum right. What acts in the next first half-step it keeps
/// itself, on every rank, from its last sum.
void ScriptClumps::push_rigid(std::size_t number, std::span<const protocol::Load> loads,
                              bool to_bodies) {
  const FixRigid& fix = *rigid_[number];
  const int bodies = (fix.*Inside::count);
  std::vector<const protocol::Load*> of_body(bodies, nullptr);
  for (const protocol::Load& load : loads) {
    const std::int64_t body = rigid_id(number, 0) - load.id;
    if (body >= 0 && body < bodies) of_body[body] = &load;
  }
  if (to_bodies) {
    for (int b = 0; b < bodies; ++b) {
      if (!of_body[b]) continue;
      add((fix.*Inside::force)[b], of_body[b]->force);
      add((fix.*Inside::turn)[b], of_body[b]->torque);
    }
    return;
  }
  const int* const body = (fix.*Inside::body_of);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body[i] < 0 || !of_body[body[i]]) continue;
    const protocol::Load& load = *of_body[body[i]];
    const double part = 1.0 / (fix.*Inside::spheres)[body[i]];
    double arm[3];
    for (int k = 0; k < 3; ++k) arm[k] = atom->x[i][k] - (fix.*Inside::place)[body[i]][k];
    domain->minimum_image(arm);
    const Vec3& f = load.force;
    const Vec3 turn{arm[1] * f[2] - arm[2] * f[1], arm[2] * f[0] - arm[0] * f[2],
                    arm[0] * f[1] - arm[1] * f[0]};
    for (int k = 0; k < 3; ++k) {
      atom->f[i][k] += part * f[k];
      atom->torque[i][k] += part * (load.torque[k] - turn[k]);
    }
  }
}

}  // namespace dem
