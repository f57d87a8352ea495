// SPDX-License-Identifier: GPL-2.0-or-later
/// The part of a scene that says what is written. SI units.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/side.h"
#include "lbm_solver/base/vec3.h"

namespace lbm {

/// Something that is measured along the run and written to a table of its own.
struct SensorScene {
  enum class Kind { Line, Plane, Side };
  Kind kind = Kind::Plane;
  std::string name;  ///< of its table, sensor-NAME.csv
  double every = 0;  ///< [s]; 0: every interval
  Vec3 from, to;   ///< ends of a line; corners of the part of the box whose cells a plane takes [m]
  int count = 20;  ///< places of a line
  int axis = 0;    ///< normal of a plane
  double at = 0.0;  ///< place of a plane along it [m]
  SideName side = SideName::Left;
};

/// Mean values of the fields over time.
struct AverageScene {
  double from = 0.0;   ///< [s]
  double every = 0.0;  ///< between two samples [s]; 0: every interval
};

struct OutputScene {
  double fields_every = 0.0;  ///< [s]; 0: none
  bool viscosity = false;     ///< among the fields
  double probe_every = 0.0;   ///< [s]; 0: every interval
  std::vector<Vec3> points;   ///< places where pressure and velocity are written [m]
  /// Numbers (ids) of the particles that have rows in the table of probes; empty: all.
  std::vector<std::int64_t> probe_particles;
  std::optional<AverageScene> average;
  std::vector<SensorScene> sensors;
};

}  // namespace lbm
