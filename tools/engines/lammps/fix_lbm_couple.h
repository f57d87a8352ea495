// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// clang-format off
#include "tools/engines/lammps/old_fmt.h"
#include <fix.h>
// clang-format on

#include <optional>
#include <string>
#include <vector>

#include "protocol/program/solid_parts.h"
#include "protocol/wire/overlap.h"
#include "protocol/wire/session.h"

namespace engine {

/// The session that `main` made; LAMMPS offers no other way to hand it to a fix.
struct Coupling {
  protocol::SolidSession* session = nullptr;
  bool agreed = false, over = false;
  static Coupling& instance();
};

/// fix ID group lbm/couple every N [gravity GX GY GZ]: as the LIGGGHTS fix of that name, for LAMMPS
/// spheres. Sends the group's particles every N steps and adds the loads that it gets for them at
/// every step. LAMMPS does not tell what its fix gravity does, so the script must, for the fluid to
/// compare. Where the fluid asks for a checkpoint, LAMMPS is set up anew at that step, as a restart
/// would, and writes its restart file; a command `restart` of the script is off from then on.
class FixLbmCouple final : public LAMMPS_NS::Fix {
 public:
  FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);
  ~FixLbmCouple() override;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup(int vflag) override;
  void post_force(int vflag) override;
  void end_of_step() override;

  void grow_arrays(int n) override;
  void copy_arrays(int from, int to, int is_delete) override;
  void set_arrays(int i) override;
  int pack_exchange(int i, double* buffer) override;
  int unpack_exchange(int i, double* buffer) override;
  int pack_restart(int i, double* buffer) override;
  void unpack_restart(int i, int nth) override;
  int size_restart(int) override { return kColumns - kId + 1; }
  int maxsize_restart() override { return kColumns - kId + 1; }

 private:
  /// Of a particle: force and torque; the id and epoch that the fluid was told last.
  static constexpr int kId = 6, kEpoch = 7, kColumns = 8;
  std::vector<protocol::Ball> balls(int group) const;
  protocol::Hello hello() const;
  void exchange(bool add_change, std::uint32_t flags = protocol::kContinue);
  void settle_again();
  void write_part();

  int substeps_ = 0;
  protocol::Vec3 gravity_{};  ///< [m/s²]
  double** held_ = nullptr;   ///< [nmax][kColumns] force [N], torque [N m] of this interval, …
  int held_still_ = 0;        ///< groups whose forces fix freeze or setforce sets
  LAMMPS_NS::bigint first_step_ = 0;
  std::int64_t interval_ = 0;
  bool stop_asked_ = false, settle_asked_ = false, checkpoint_asked_ = false;
  bool settling_again_ = false;                ///< in settle_again
  std::optional<protocol::SolidParts> parts_;  ///< once the two have agreed
};

}  // namespace engine
