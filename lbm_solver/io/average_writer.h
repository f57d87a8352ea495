// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/units.h"
#include "lbm_solver/io/cell_fields.h"

namespace lbm {

/// Means over time and root mean squares of what deviates from them, SI units.
struct FieldAverages {
  double from = 0.0, to = 0.0;  ///< first and last sample [s]
  std::int64_t samples = 0;
  /// velocity_mean, velocity_rms [m/s], pressure_mean, pressure_rms [Pa]; no number: never fluid
  CellFields cells;
};

/// Writes `averages.h5`, and `averages.xdmf` for ParaView, as `fields.h5` in shape and place.
/// Collective.
void write_averages(const std::string& folder, const FieldAverages& averages, const Units& units,
                    const Decomposition& ranks);

}  // namespace lbm
