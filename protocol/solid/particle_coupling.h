// SPDX-License-Identifier: MIT
/// What a `fix lbm/couple` does, whatever the engine whose fix it is: LIGGGHTS' and LAMMPS' are
/// thin adaptors to it.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <exception>
#include <optional>
#include <vector>

#include "protocol/program/solid_parts.h"
#include "protocol/solid/clump_coupling.h"
#include "protocol/wire/overlap.h"
#include "protocol/wire/session.h"

namespace protocol {

/// Columns that are kept of each particle, and travel with it: force and torque of this interval;
/// id and epoch that the fluid was told last.
enum HeldColumn : int {
  kHeldForce = 0,
  kHeldTorque = 3,
  kHeldId = 6,
  kHeldEpoch = 7,
  kHeldColumns
};

/// The particles of this rank where the engine keeps them. Valid until it sorts them.
struct EngineParticles {
  int count = 0;
  int dimension = 3;
  int group = 1;   ///< bit in `mask` of those that couple
  int frozen = 0;  ///< bits of those whose forces a later fix sets
  const int *id = nullptr, *type = nullptr, *mask = nullptr;
  const double *radius = nullptr, *mass = nullptr;
  double *const *x = nullptr, *const *v = nullptr, *const *omega = nullptr;
  double *const *force = nullptr, *const *torque = nullptr;
  double* const* held = nullptr;  ///< [count][at least kHeldColumns]
  /// Of each the clump that it is a sphere of, or kItself; null where there is no clump.
  const std::int64_t* carrier = nullptr;
};

/// Places and radii of the particles of a group, for `find_overlap`; without those that have none.
std::vector<Ball> balls_of(const EngineParticles& particles, int group);

/// How far the conversation has come, for the program around the engine.
struct Progress {
  bool agreed = false;  ///< handshakes exchanged: the fluid waits for states
  bool over = false;    ///< the last states are sent
};

/// What the coupling asks of an engine.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual EngineParticles particles() = 0;
  virtual MPI_Comm communicator() const = 0;
  virtual std::int64_t step_number() const = 0;
  /// Time step and box of now. @throws ProgramError  they are not what was agreed
  virtual Setting setting() const = 0;
  /// What there is to say of this rank beside its states.
  virtual std::optional<SolidReport> report() const { return {}; }
  /// The clumps that this rank answers for; those of all ranks are all clumps that the carriers of
  /// `particles` name.
  virtual std::vector<EngineClump> clumps() { return {}; }
  /// Adds loads to clumps, those of all ranks.
  virtual void push_clumps(std::span<const Load> /*loads*/, Moment /*when*/) {}
  /// Index of the particle of an id, which is one of `particles` where it is below their number.
  virtual int index_of(std::int64_t id) const = 0;
  /// Does in the middle of a run what its beginning does: sorts and distributes particles, finds
  /// neighbours, computes forces. Must end in `ParticleCoupling::resume`.
  virtual void set_up_again() = 0;
  /// Writes what a restart from this interval needs; all ranks together.
  virtual void write_part(SolidParts& parts, std::int64_t interval) = 0;
  /// What the fluid wants, from its loads.
  virtual void note_wishes(std::uint32_t /*flags*/) {}
  /// The wait for loads has failed; the error goes on.
  virtual void note_failure(const std::exception& /*error*/) {}
  virtual void note_end() {}
};

/// Sends the particles of a rank every interval, keeps the loads that come for them, and adds these
/// to the forces of every step. `engine`, `session` and `progress` must outlive it.
class ParticleCoupling {
 public:
  ParticleCoupling(Engine& engine, SolidSession& session, Progress& progress, int substeps)
      : engine_(engine), session_(session), progress_(progress), substeps_(substeps) {}

  /// At the beginning of the first run: agrees, and gets the loads of the first interval.
  void begin(const Hello& mine);
  /// At the end of `Engine::set_up_again`: writes the part of a checkpoint that was asked for,
  /// sends the states.
  void resume();
  /// Adds the loads that are held to forces and torques. @param when  set-up or step
  void add_loads(Moment when = Moment::Step);
  /// After each step; exchanges at the end of an interval.
  void end_step();

  bool begun() const { return begun_; }
  bool setting_up_again() const { return setting_up_again_; }
  int substeps() const { return substeps_; }
  std::int64_t interval() const { return interval_; }
  void set_interval(std::int64_t interval) { interval_ = interval; }
  std::int64_t first_step() const { return first_step_; }
  SolidParts& parts() { return *parts_; }
  ClumpCoupling& clumps() { return clumps_; }

 private:
  void gather(const EngineParticles& particles);
  void gather_clumps(const EngineParticles& particles);
  void take_clump_loads(std::span<const Load> loads, bool add_change);
  void send_states(std::uint32_t flags = kContinue);
  void take_loads(bool add_change);
  void forward(const EngineParticles& p, std::vector<Load>& orphans, bool add_change);

  Engine& engine_;
  SolidSession& session_;
  Progress& progress_;
  int substeps_;
  std::int64_t interval_ = 0, first_step_ = 0;
  bool begun_ = false, setting_up_again_ = false;
  bool stop_asked_ = false, settle_asked_ = false, checkpoint_asked_ = false;
  bool overlapped_ = false;  // loads are taken at the end of their interval
  bool underway_ = false;    // loads of the states sent last have not been taken
  std::optional<SolidParts> parts_;
  std::vector<State> states_;  // buffers of one exchange
  std::vector<Shape> shapes_;
  std::vector<int> local_;  ///< of each state the particle; of a clump and its spheres see below
  static constexpr int kClump = -1, kPart = -2;
  ClumpCoupling clumps_;
  bool any_clumps_ = false;
};

}  // namespace protocol
