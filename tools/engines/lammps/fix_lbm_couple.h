// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// clang-format off
#include "tools/engines/lammps/old_fmt.h"
#include <fix.h>
// clang-format on

#include <optional>
#include <string>

#include "protocol/solid/particle_coupling.h"

namespace engine {

/// The session that `main` made; LAMMPS offers no other way to hand it to a fix.
struct Coupling : protocol::Progress {
  protocol::SolidSession* session = nullptr;
  static Coupling& instance();
};

/// fix ID group lbm/couple every N [gravity GX GY GZ]: as the LIGGGHTS fix of that name, for LAMMPS
/// spheres. Sends the group's particles every N steps and adds the loads that it gets for them at
/// every step. LAMMPS does not tell what its fix gravity does, so the script must, for the fluid to
/// compare. Where the fluid asks for a checkpoint, LAMMPS is set up anew at that step, as a restart
/// would, and writes its restart file; a command `restart` of the script is off from then on.
class FixLbmCouple final : public LAMMPS_NS::Fix, private protocol::Engine {
 public:
  FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);
  ~FixLbmCouple() override;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup(int vflag) override;
  void post_force(int) override { coupling_->add_loads(); }
  void end_of_step() override;

  void grow_arrays(int n) override;
  void copy_arrays(int from, int to, int is_delete) override;
  void set_arrays(int i) override;
  int pack_exchange(int i, double* buffer) override;
  int unpack_exchange(int i, double* buffer) override;
  int pack_restart(int i, double* buffer) override;
  void unpack_restart(int i, int nth) override;
  int size_restart(int) override { return kColumns - protocol::kHeldId + 1; }
  int maxsize_restart() override { return kColumns - protocol::kHeldId + 1; }

 private:
  static constexpr int kColumns = protocol::kHeldColumns;

  // what the coupling asks of LAMMPS
  protocol::EngineParticles particles() override;
  MPI_Comm communicator() const override { return world; }
  std::int64_t step_number() const override;
  protocol::Setting setting() const override;
  int index_of(std::int64_t id) const override;
  void set_up_again() override;
  void write_part(protocol::SolidParts& parts, std::int64_t interval) override;

  protocol::Hello hello() const;
  [[noreturn]] void fail(const std::string& text) const;

  std::optional<protocol::ParticleCoupling> coupling_;
  protocol::Vec3 gravity_{};  ///< [m/s²]
  double** held_ = nullptr;   ///< [nmax][kColumns] force [N], torque [N m] of this interval, …
  int frozen_groups_ = 0;     ///< whose forces fix freeze or setforce sets
};

}  // namespace engine
