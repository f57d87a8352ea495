// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/field/decomposition.h"

namespace lbm {

/// How a run is to go on.
struct RestartOptions {
  std::string from;                 ///< "checkpoint" or "fault"; empty: it begins anew
  std::vector<std::string> accept;  ///< keys or tables of the scene that may have changed
};

/// What a run goes on from: a pair of a fluid's part and, in a coupled run, a solid's.
struct Restart {
  std::string path;        ///< of the fluid's part
  std::string solid_part;  ///< path of the solid's; empty for a fluid alone
  std::int64_t interval = 0;
  double step = 0.0;  ///< dt of the run [s]
  Record record;
  bool earlier = false;  ///< the pair before the last one
  std::string remark;    ///< what is wrong with the last one then
};

/// Files of the last pair and of the one before it, in the output folder.
std::string fluid_part(const std::string& folder, const std::string& name);
std::string fluid_part_before(const std::string& folder, const std::string& name);

/// The last pair that is whole and undamaged; nothing where the run begins anew.
/// @throws InputError  there is none; says what is wrong with each
std::optional<Restart> find_restart(const Scene& scene, const std::string& folder,
                                    const RestartOptions& options);

/// The last pair, or the one before it, which another rank has found to be whole: it is read
/// without looking for damage, which takes reading all of it.
Restart take_restart(const Scene& scene, const std::string& folder, const RestartOptions& options,
                     bool earlier);

/// Refuses to go on with another scene than that of the checkpoint.
/// @throws InputError  lists every difference: key, then, now
void check_same_scene(const Restart& restart, const Scene& scene, const Plan& plan,
                      const RestartOptions& options);

/// The fluid's part of a checkpoint around the records of a run.
/// @param solid_part  path; its length and checksum are kept too; empty: of a fluid alone, or a
/// fault
/// @throws InputError  the solid's part is not there
Record checkpoint_record(const Scene& scene, const Plan& plan, std::int64_t interval,
                         const std::string& solid_part);

/// Keys of a scene that a restart may change freely, and those that it may with --accept.
bool may_change(const std::string& key);
bool may_be_accepted(const std::string& key);

}  // namespace lbm
