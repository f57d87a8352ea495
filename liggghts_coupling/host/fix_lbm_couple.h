// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <fix.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/program/solid_parts.h"
#include "protocol/wire/session.h"

namespace dem {

/// `fix ID group lbm/couple every N [timeout S] [record FILE]`
///
/// Every N steps: sends position, velocity and angular velocity of the group's particles to the
/// fluid and receives the mean hydrodynamic force and torque on each for the next N steps, which it
/// adds at every step. An id that passes to another particle (delete_atoms renumbers) gets another
/// epoch, as does a particle that the script puts elsewhere between runs. The held loads migrate
/// with the particles, are kept in restart files, and can be dumped as f_ID[1] … f_ID[6]. A script
/// may have several runs, and insert or delete particles between them. At the times at
/// which a run may be stopped, LIGGGHTS is set up anew at that step, as a restart would, and writes
/// its restart file where the fluid asks for one: the run goes on to the bit as one that was
/// started from it. The ledger of broken bonds is part of it.
class FixLbmCouple final : public LAMMPS_NS::Fix {
 public:
  FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);
  ~FixLbmCouple() override;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override { count_leaving(); }
  void setup(int vflag) override;
  void post_force(int vflag) override;
  void end_of_step() override;
  void post_run() override;

  // LIGGGHTS asks every fix which particles may be there, and takes its cut-offs from that
  double min_rad(int type) override {
    return type_radii_.contains(type) ? type_radii_[type].lo : 0;
  }
  double max_rad(int type) override {
    return type_radii_.contains(type) ? type_radii_[type].hi : 0;
  }
  int min_type() override { return type_radii_.empty() ? 0 : type_radii_.begin()->first; }
  int max_type() override { return type_radii_.empty() ? 0 : type_radii_.rbegin()->first; }

  void write_restart(FILE* file) override;
  void restart(char* buffer) override;
  void grow_arrays(int n) override;
  void copy_arrays(int from, int to, int is_delete) override;
  void set_arrays(int i) override;
  int pack_exchange(int i, double* buffer) override;
  int unpack_exchange(int i, double* buffer) override;
  int pack_restart(int i, double* buffer) override;
  void unpack_restart(int i, int nth) override;
  int size_restart(int) override { return kKept + 1; }
  int maxsize_restart() override { return kKept + 1; }
  double memory_usage() override;

 private:
  /// Of a particle: force and torque; the id and epoch that the fluid was told last; place and
  /// radius at the end of the last run.
  static constexpr int kValues = 6, kId = 6, kEpoch = 7, kKept = 8, kPlace = 8, kRadius = 11,
                       kColumns = 12;

  void parse(int narg, char** arg);
  void begin_recording() const;
  void gather();
  void count_leaving();
  protocol::SolidReport report() const;
  protocol::Hello hello() const;
  void begin();
  void go_on() const;
  void begin_anew_where_moved() const;
  void send_states(std::uint32_t flags = protocol::kContinue);
  protocol::SolidSession::Reply collect();
  void take_loads(bool add_change);
  void hold(int i, const protocol::Load& load, bool add_change);
  void forward(std::vector<protocol::Load>& orphans, bool add_change);
  void settle_again();
  void write_checkpoint();
  void keep_last_state(const std::exception& error);
  void note_particles();
  void write_part(protocol::SolidParts& parts);
  [[noreturn]] void fail(const std::string& text) const;

  int substeps_ = 0;
  std::optional<double> timeout_;  ///< [s]; else the fluid's
  std::string record_;
  double** held_ = nullptr;  ///< [nmax][kColumns]; force [N], torque [N m] of this interval, …
  int held_still_ = 0;       ///< groups whose forces fix freeze or setforce sets
  LAMMPS_NS::bigint first_step_ = 0, step_ = 0;  ///< of the first run; the one that ended last
  LAMMPS_NS::bigint marked_ = -1;                ///< step of which places are kept
  double time_step_ = 0.0;                       ///< [s], of all runs
  double waited_before_ = 0.0;                   ///< [s], until the first step
  std::int64_t interval_ = 0;
  std::int64_t left_ = 0;  ///< particles, since the beginning of the coupled run, of this process
  bool stop_asked_ = false, settle_asked_ = false, checkpoint_asked_ = false;
  bool overlapped_ = false;  ///< loads are taken at the end of their interval
  bool underway_ = false;    ///< loads of the states sent last have not been taken
  bool set_up_ = false;
  bool settling_again_ = false;  ///< in settle_again
  /// Smallest and largest of each type that was there when a run began, where the scene has
  /// checkpoints [m]: a run that goes on must find its neighbours in the same way when they have
  /// left.
  std::map<int, protocol::Range> type_radii_;
  std::optional<protocol::SolidParts> parts_;  ///< once the two have agreed
  std::vector<protocol::State> states_;        // buffers of one exchange
  std::vector<protocol::Shape> shapes_;
  std::vector<int> local_;
};

}  // namespace dem
