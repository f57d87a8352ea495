// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "lbm_solver/coupling/diagnosis.h"
#include "lbm_solver/coupling/field_average.h"
#include "lbm_solver/coupling/held_flow.h"
#include "lbm_solver/coupling/obstacle_loads.h"
#include "lbm_solver/coupling/output_times.h"
#include "lbm_solver/coupling/part_clock.h"
#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/coupling/sensors.h"
#include "lbm_solver/coupling/start_check.h"
#include "lbm_solver/coupling/steady_watch.h"
#include "lbm_solver/io/field_writer.h"
#include "lbm_solver/io/log.h"
#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/io/summary.h"
#include "lbm_solver/solver/plan.h"
#include "lbm_solver/solver/viscosity_use.h"

namespace lbm {

/// Everything that watches a run without changing it: guard, probes, fields, progress, summary.
/// What belongs to a state (fields, points, particles' motion) is written at that state, the first
/// one at t = 0; what belongs to an interval (loads) once it is over.
/// Where several ranks share the box, all call the same functions at the same states; the first
/// writes the files.
class Observers {
 public:
  /// @param first  state at which the run begins or goes on; earlier output is kept
  Observers(const Scene& scene, const Plan& plan, const Decomposition& ranks,
            const std::string& folder, Log& log, std::int64_t first = 0);

  /// The run stops at this state, which --until may have put before the scene's end: progress
  /// counts to it.
  void ends_at(std::int64_t state) { end_ = state; }

  /// Particles that began deep in a solid, for a diagnosis.
  void remember(DeepStarts starts) { deep_starts_ = std::move(starts); }

  /// What a checkpoint must keep of the observers, complete on rank 0; `load` wants it on every
  /// rank. To be asked for before `at_state`, which the run that goes on calls again. Collective.
  Record save() const;
  void load(const Record& record);
  /// The ranks have other blocks from now on; before `load` of what was saved on those before.
  void move_to(const Decomposition& ranks);

  /// A picture of the fields is due at this state.
  bool draws_at(std::int64_t state) const { return field_times_ && field_times_->due(state); }

  /// The first state after this one that anything looks at in a fluid alone.
  std::int64_t next_look(std::int64_t state) const;

  /// At a state, before its interval begins: fields, points, and the mean loads on obstacles until
  /// then, where they are due. At the last one all of them, and the particles' rows.
  /// @param particles  null for a fluid alone
  /// @throws NumericsError
  void at_state(std::int64_t state, Fluid& fluid, const Particles* particles, bool last = false);
  /// After the interval that began at a state, whose loads are known: guards the next state, and
  /// writes the particles' rows of this one.
  /// @throws NumericsError
  void after_interval(std::int64_t state, Fluid& fluid, const Particles* particles);
  /// Whether anything sums loads: then a fluid alone calls add_loads after each step.
  bool sums() const {
    return obstacles_ || std::any_of(sensors_.begin(), sensors_.end(),
                                     [](const auto& sensor) { return sensor->sums(); });
  }
  /// After each fluid step: loads in the order of obstacle_bodies.
  void add_loads(Fluid& fluid, std::span<const BodyLoad> loads) {
    if (obstacles_) obstacles_->add(fluid, loads);
    for (const auto& sensor : sensors_) sensor->add(fluid);
  }
  /// A fluid alone whose velocity no longer changes (run.steady_below).
  bool steady() const { return steady_ && steady_->steady(); }

  Summary summary(double wall_seconds) const;

 private:
  double time_of(std::int64_t state) const { return static_cast<double>(state) * plan_.interval(); }
  void guard(std::int64_t state, Fluid& fluid, const Particles* particles);
  void measure(std::int64_t state, Fluid& fluid, bool last);
  Particles::Everything shown(const Particles& particles) const;
  void add_particles(const Particles& particles, FieldFrame& frame) const;
  void add_bonds(const std::vector<protocol::Particle>& particles,
                 const std::vector<protocol::Bond>& bonds, FieldFrame& frame) const;
  void write_fields(double time, Fluid& fluid, const Particles* particles);
  void warn_of_buried(double time, std::span<const protocol::Particle> particles);
  void warn_of_absent(std::span<const protocol::Particle> particles);
  void write_points(double time, Fluid& fluid);
  void write_particles(double time, const Particles& particles);
  void report_viscosity(std::int64_t state, const Fluid& fluid);
  std::string speed_text() const;
  void report_progress(std::int64_t state, const Particles* particles);

  const Scene& scene_;
  const Plan& plan_;
  Decomposition ranks_;
  Log& log_;
  const OutputTimes probe_times_;
  std::optional<OutputTimes> field_times_;  // where fields are asked for
  std::optional<ProbeWriter> probes_;       // particles
  std::optional<CsvWriter> points_;
  std::optional<HeldFlow> flow_;  // where one is held
  std::optional<ObstacleLoads> obstacles_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::optional<FieldAverage> average_;
  const std::string folder_;
  std::optional<SteadyWatch> steady_;
  std::optional<FieldWriter> fields_;      // of rank 0, like the tables
  std::vector<Geometry> images_;           // among the obstacles, where fields are asked for
  std::map<std::string, double> writing_;  // kind of file -> seconds
  bool fresh_ = true;                      // it does not go on from a checkpoint
  std::int64_t first_, end_, guard_every_, intervals_done_ = 0;
  double max_speed_ = 0.0, last_speed_ = 0.0;  // of the fluid, lattice units
  bool speed_known_ = false;                   // last_speed_ is of this run
  bool chosen_seen_ = false;                   // the chosen particles have been looked for
  SpeedRecord speeds_;
  DeepStarts deep_starts_;
  bool buried_told_ = false;                            // particles in what moves
  bool warned_ = false;                                 // of a speed above kWarnSpeed
  std::optional<ViscosityUse> viscosity_;               // at the end, where it varies
  double mass_excess_ = 0.0, first_mass_excess_ = 0.0;  // what came through patches left out
  std::chrono::steady_clock::time_point start_, last_progress_;
};

}  // namespace lbm
