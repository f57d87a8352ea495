// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/units.h"
#include "lbm_solver/field/domain.h"

namespace lbm {

/// Means over time and root mean squares of what deviates from them, SI units; x runs fastest.
struct FieldAverages {
  double from = 0.0, to = 0.0;  ///< first and last sample [s]
  std::int64_t samples = 0;
  std::vector<float> velocity_mean, velocity_rms;  ///< [nz][ny][nx][3] [m/s]
  std::vector<float> pressure_mean, pressure_rms;  ///< [nz][ny][nx] [Pa]; no number: never fluid
};

/// Writes `averages.h5`, and `averages.xdmf` for ParaView, as `fields.h5` in shape and place.
void write_averages(const std::string& folder, const FieldAverages& averages, const Units& units,
                    const Domain& domain);

}  // namespace lbm
