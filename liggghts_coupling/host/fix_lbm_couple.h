// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <fix.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "liggghts_coupling/bond/bond_book.h"
#include "liggghts_coupling/host/script_clumps.h"
#include "protocol/solid/particle_coupling.h"

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
class FixLbmCouple final : public LAMMPS_NS::Fix, private protocol::Engine {
 public:
  FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);
  ~FixLbmCouple() override;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override { count_leaving(); }
  void setup(int vflag) override;
  void post_force(int) override { coupling_->add_loads(); }
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
  /// Of a particle: what the coupling keeps, also in restart files; place and radius at the end of
  /// the last run.
  static constexpr int kLoads = 6, kKept = protocol::kHeldColumns, kPlace = kKept,
                       kRadius = kPlace + 3, kColumns = kRadius + 1;

  // what the coupling asks of LIGGGHTS
  protocol::EngineParticles particles() override;
  MPI_Comm communicator() const override { return world; }
  std::int64_t step_number() const override;
  protocol::Setting setting() const override;
  std::optional<protocol::SolidReport> report() const override;
  int index_of(std::int64_t id) const override;
  std::vector<protocol::EngineClump> clumps() override { return clumps_.clumps(); }
  void push_clumps(std::span<const protocol::Load> loads, protocol::Moment when) override {
    clumps_.push(loads, when);
  }
  void set_up_again() override;
  void write_part(protocol::SolidParts& parts, std::int64_t interval) override;
  void note_wishes(std::uint32_t flags) override;
  void note_failure(const std::exception& error) override;
  void note_end() override;

  void begin();
  void go_on() const;
  void begin_anew_where_moved() const;
  void begin_recording(const std::string& record) const;
  void count_leaving();
  void advise_on_ranks() const;
  void note_particles();
  protocol::Hello hello() const;
  [[noreturn]] void fail(const std::string& text) const;

  std::shared_ptr<BondBook> bonds_ = BondBook::of(lmp);
  std::optional<protocol::ParticleCoupling> coupling_;
  ScriptClumps clumps_{lmp};
  double** held_ = nullptr;        ///< [nmax][kColumns]; force [N], torque [N m], …
  int frozen_groups_ = 0;          ///< whose forces fix freeze or setforce sets
  LAMMPS_NS::bigint step_ = 0;     ///< of the run that ended last
  LAMMPS_NS::bigint marked_ = -1;  ///< step of which places are kept
  double time_step_ = 0.0;         ///< [s], of all runs
  double waited_before_ = 0.0;     ///< [s], until the first step
  double counted_ = 0.0;           ///< particles of this rank, summed over the intervals
  std::int64_t left_ = 0;  ///< particles, since the beginning of the coupled run, of this process
  std::set<std::int64_t> left_clumps_;  ///< those of all processes that count among them
  /// Smallest and largest of each type that was there when a run began, where the scene has
  /// checkpoints [m]: a run that goes on must find its neighbours in the same way when they have
  /// left.
  std::map<int, protocol::Range> type_radii_;
};

}  // namespace dem
