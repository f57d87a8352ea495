// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/io/log.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Particles that began deep in a solid: number, and how deep in what.
using DeepStarts = std::map<std::int64_t, std::string>;

/// Warns of particles that begin deep in an obstacle or a wall: where a script has placed them, no
/// check of the scene can know. Before the first particles are placed in the fluid, so that its
/// cells show obstacles alone. Collective. @return  known to rank 0
/// @throws InputError  the centre of one lies in the surface of a mesh, from where a contact has no
///                     direction
DeepStarts warn_of_starts(const Scene& scene, const Plan& plan, const Fluid& fluid,
                          const Particles& particles, Log& log);

/// Warns where the solid's handshake counts other particles than lie in the box. Collective.
/// @param told  what it counts; empty: it does not say
void warn_of_count(const std::optional<std::int64_t>& told, const Decomposition& ranks,
                   const Particles& particles, Log& log);

/// What to say of particles whose centres lie in a mesh that moves, and has gone over them; empty
/// where there is none.
/// @param starts  of those that began in a solid: they are known
std::string buried_text(const Scene& scene, std::span<const protocol::Particle> particles,
                        double time, const DeepStarts& starts);

}  // namespace lbm
