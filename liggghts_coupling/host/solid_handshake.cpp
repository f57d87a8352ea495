// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/solid_handshake.h"

#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <fix_gravity.h>
#include <fmt/core.h>
#include <modify.h>
#include <update.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "liggghts_coupling/host/solid_walls.h"

namespace dem {

using protocol::Hello;

double particle_volume(int dimension, double radius, double depth) {
  const double disc = std::numbers::pi * radius * radius;
  return dimension == 2 ? disc * depth : disc * radius * 4.0 / 3.0;
}

SolidHandshake::SolidHandshake(LAMMPS_NS::LAMMPS* lammps, int groupbit, int substeps,
                               const ScriptClumps& clumps)
    : Pointers(lammps), groupbit_(groupbit), substeps_(substeps), clumps_(clumps) {}

Hello SolidHandshake::collect() {
  Hello hello;
  hello.role = protocol::Role::Solid;
  hello.program = "liggghts";
  hello.program_version = "3.8.0 + bplbm " BPLBM_VERSION;
  if (const std::string units = update->unit_style; units != "si") hello.units = units;
  hello.step = update->dt;
  hello.solid_steps = static_cast<std::uint32_t>(substeps_);
  geometry(hello);
  forces(hello);
  particles(hello);
  tell_walls(*lmp, hello);
  return hello;
}

/// A script that forgets its integrator runs to the end, and nothing moves.
void SolidHandshake::expect_motion() const {
  if (clumps_.multisphere()) return;
  for (int i = 0; i < modify->nfix; ++i)
    if (modify->fix[i]->time_integrate) return;
  if (comm->me == 0)
    fmt::print(stderr,
               "liggghts | warning | no fix of the script moves its particles: they will stay "
               "where they are; add fix ID all nve/sphere\n");
}

void SolidHandshake::geometry(Hello& hello) const {
  if (domain->triclinic)
    error->all(FLERR, "fix lbm/couple: a triclinic box cannot couple; use an orthogonal region");
  if (domain->nonperiodic == 2)
    error->all(FLERR, "fix lbm/couple: a shrink-wrapped box cannot couple; use boundary p or f");
  hello.dimension = static_cast<std::uint32_t>(domain->dimension);
  for (int k = 0; k < 3; ++k) {
    hello.box_lo[k] = domain->boxlo[k];
    hello.box_hi[k] = domain->boxhi[k];
    hello.periodic[k] = domain->periodicity[k] != 0;
  }
  hello.depth = hello.box_hi[2] - hello.box_lo[2];
}

void SolidHandshake::forces(Hello& hello) const {
  bool buoyancy = false;
  for (int i = 0; i < modify->nfix; ++i) {
    if (std::string(modify->fix[i]->style) == "buoyancy") buoyancy = true;
    auto* gravity = dynamic_cast<LAMMPS_NS::FixGravity*>(modify->fix[i]);
    if (!gravity) continue;
    double g[3];
    gravity->get_gravity(g);
    for (int k = 0; k < 3; ++k) hello.gravity[k] += g[k];
  }
  // Without a fix of its own the solid leaves buoyancy to whatever the fluid's scene says.
  const auto fluid_says = hello.buoyancy;
  hello.buoyancy = buoyancy ? protocol::Buoyancy::BySolid : fluid_says;
}

void SolidHandshake::particles(Hello& hello) const {
  constexpr double huge = std::numeric_limits<double>::max();
  double least[3] = {huge, huge, huge};
  double most[3] = {0.0, 0.0, -huge};
  const auto note = [&](int k, double value) {
    least[k] = std::min(least[k], value);
    most[k] = std::max(most[k], value);
  };
  std::int64_t count = 0;
  const std::int64_t* carriers = clumps_.carriers();
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit_)) continue;
    note(0, atom->radius[i]);
    note(2, atom->x[i][2]);
    if (carriers && carriers[i] != protocol::kItself) continue;
    ++count;
    note(1, atom->rmass[i] / particle_volume(domain->dimension, atom->radius[i], hello.depth));
  }
  for (const protocol::EngineClump& clump : clumps_.clumps()) {
    ++count;
    if (clump.volume > 0.0) note(1, clump.mass / clump.volume);
  }
  MPI_Allreduce(MPI_IN_PLACE, least, 3, MPI_DOUBLE, MPI_MIN, world);
  MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, world);
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT64_T, MPI_SUM, world);
  hello.particles = count;
  if (count == 0) return;
  if (domain->dimension == 2 && most[2] - least[2] > 1e-3 * least[0])
    error->all(FLERR,
               fmt::format("fix lbm/couple: the {} discs lie at z from {:.6g} to {:.6g} m; in "
                           "two dimensions all lie in one plane: create them at z = 0, in a "
                           "region that is thin in z",
                           count, least[2], most[2])
                   .c_str());
  hello.radius = protocol::Range{least[0], most[0]};
  if (least[1] <= most[1]) hello.density = protocol::Range{least[1], most[1]};
}

}  // namespace dem
