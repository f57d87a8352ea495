// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "lbm_solver/coupling/particles.h"
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
class Observers {
 public:
  Observers(const Scene& scene, const Plan& plan, const std::string& folder, Log& log);

  /// After an interval's loads are known. @throws NumericsError
  void after_interval(std::int64_t interval, Fluid& fluid, const Particles& particles);
  /// At the last state, which has no loads.
  void at_end(std::int64_t interval, Fluid& fluid, const Particles& particles);

  Summary summary(double wall_seconds) const;

 private:
  void guard(std::int64_t interval, Fluid& fluid, const Particles& particles);
  void write_fields(double time, Fluid& fluid, const Particles& particles);
  void report_progress(std::int64_t interval);

  const Scene& scene_;
  const Plan& plan_;
  Log& log_;
  ProbeWriter probes_;
  std::optional<FieldWriter> fields_;
  std::int64_t guard_every_, intervals_done_ = 0;
  double next_probe_ = 0.0, next_field_ = 0.0;
  double max_speed_ = 0.0, last_speed_ = 0.0;  // of the fluid, lattice units
  double mass_excess_ = 0.0;
  std::chrono::steady_clock::time_point start_, last_progress_;
};

}  // namespace lbm
