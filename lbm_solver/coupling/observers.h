// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "lbm_solver/coupling/obstacle_loads.h"
#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/coupling/steady_watch.h"
#include "lbm_solver/io/field_writer.h"
#include "lbm_solver/io/log.h"
#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/io/summary.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Wall time by part of the time step.
class PartClock {
 public:
  /// Charges the time since the last call to `part`.
  void charge(const char* part);
  double total() const;
  const std::map<std::string, double>& parts() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), last_ = start_;
  std::map<std::string, double> seconds_;
};

/// Everything that watches a run without changing it: guard, probes, fields, progress, summary.
/// Where several ranks share the box, all call the same functions at the same intervals; the first
/// writes the files.
class Observers {
 public:
  /// @param first  interval at which the run begins or goes on; earlier output is kept
  Observers(const Scene& scene, const Plan& plan, const Decomposition& ranks,
            const std::string& folder, Log& log, std::int64_t first = 0);

  /// What a checkpoint must keep of the observers; the same on every rank.
  std::vector<double> state() const;
  void restore(const std::vector<double>& state);

  /// A picture of the fields is due at this interval.
  bool draws_at(std::int64_t interval) const;

  /// The first interval, from this one on, whose end anything looks at in a fluid alone.
  std::int64_t next_look(std::int64_t interval) const;

  /// After an interval's loads are known. @param particles  null for a fluid alone
  /// @throws NumericsError
  void after_interval(std::int64_t interval, Fluid& fluid, const Particles* particles);
  /// At the last state, which has no loads.
  void at_end(std::int64_t interval, Fluid& fluid, const Particles* particles);
  /// After each fluid step of a scene with obstacles: loads in the order of obstacle_bodies.
  void add_loads(std::span<const BodyLoad> loads) { obstacles_->add(loads); }
  /// A fluid alone whose velocity no longer changes (run.steady_below).
  bool steady() const { return steady_ && steady_->steady(); }

  Summary summary(double wall_seconds) const;

 private:
  void guard(std::int64_t interval, Fluid& fluid, const Particles* particles);
  void add_particles(const Particles& particles, FieldFrame& frame) const;
  void add_bonds(const std::vector<protocol::Particle>& particles,
                 const protocol::BondReport& bonds, FieldFrame& frame) const;
  void write_fields(double time, Fluid& fluid, const Particles* particles);
  void write_probes(double time, Fluid& fluid, const Particles* particles, bool last);
  void report_progress(std::int64_t interval, const Particles* particles);

  const Scene& scene_;
  const Plan& plan_;
  const Decomposition ranks_;
  Log& log_;
  bool draws_ = false;                 // fields are asked for
  std::optional<ProbeWriter> probes_;  // particles
  std::optional<CsvWriter> points_;
  std::optional<ObstacleLoads> obstacles_;
  std::optional<SteadyWatch> steady_;
  std::optional<FieldWriter> fields_;  // of rank 0, like the tables
  std::int64_t first_, guard_every_, intervals_done_ = 0;
  double next_probe_ = 0.0, next_field_ = 0.0;
  double max_speed_ = 0.0, last_speed_ = 0.0;           // of the fluid, lattice units
  bool warned_ = false;                                 // of a speed above kWarnSpeed
  double mass_excess_ = 0.0, first_mass_excess_ = 0.0;  // what came through patches left out
  std::chrono::steady_clock::time_point start_, last_progress_;
};

}  // namespace lbm
