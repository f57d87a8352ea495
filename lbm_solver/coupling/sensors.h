// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/coupling/output_times.h"
#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/solver/plan.h"
#include "lbm_solver/solver/plane_flow.h"
#include "lbm_solver/solver/side_loads.h"

namespace lbm {

/// One sensor of the scene: writes rows to its table, SI units. All functions are collective.
class Sensor {
 public:
  /// @param keep_until  a run that goes on keeps the rows before this time
  Sensor(const SensorScene& scene, const BoxScene& box, const Plan& plan,
         const Decomposition& ranks, const std::string& folder, double keep_until);
  virtual ~Sensor() = default;

  bool due(std::int64_t state) const { return times_.due(state); }
  std::int64_t next(std::int64_t state) const { return times_.next(state); }
  virtual void write(double time, Fluid& fluid) = 0;
  /// Whether it looks at every step.
  virtual bool sums() const { return false; }
  virtual void add(const Fluid&) {}
  virtual Record save() const { return {}; }
  /// @throws std::invalid_argument where it is of another sensor
  virtual void load(const Record&) {}
  /// See Observers.
  virtual void move_to(const Decomposition& ranks) { ranks_ = ranks; }

 protected:
  void open_table(const std::string& columns);

  const SensorScene scene_;
  const BoxScene box_;
  const Units units_;
  Decomposition ranks_;
  std::unique_ptr<CsvWriter> table_;  // of rank 0

 private:
  std::string path_;
  double keep_until_;
  OutputTimes times_;
};

/// Those of a scene; none costs nothing.
std::vector<std::unique_ptr<Sensor>> make_sensors(const Scene& scene, const Plan& plan,
                                                  const Decomposition& ranks,
                                                  const std::string& folder, double keep_until);

}  // namespace lbm
