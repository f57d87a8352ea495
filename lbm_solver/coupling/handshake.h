// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lbm_solver/solver/plan.h"
#include "protocol/wire/messages.h"

namespace lbm {

/// Where a run begins, and where its checkpoints lie.
struct RunStart {
  std::int64_t interval = 0;                  ///< 0, or that of the checkpoint it goes on from
  std::string out = "out";                    ///< folder of all output, as the user named it
  std::string checkpoint = "out/checkpoint";  ///< path without ending
  std::string solid_part = "none";            ///< the solid's file of the one it goes on from
};

/// Writes the scene's meshes as they lie in the box, mesh1.stl, mesh2.stl, …, for the solid's
/// script (its variables mesh1, …) and for ParaView. @throws InputError  the folder cannot be
/// written
void write_meshes(const Scene& scene, const std::string& folder);

/// What the fluid says to the solid: everything of the plan that both must agree on, and the
/// variables that its script may use instead of numbers of its own.
/// @param cells  of this rank, where several share the box
protocol::Hello make_handshake(const Scene& scene, const Plan& plan, const RunStart& start = {},
                               const std::optional<Block>& cells = {});
/// Its subdomain is that of these cells.
void set_subdomain(const Units& units, const Domain& domain, const Block& cells,
                   protocol::Hello& handshake);

}  // namespace lbm
