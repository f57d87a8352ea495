// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/summary.h"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lbm_solver/base/errors.h"

namespace lbm {

void write_summary(const std::string& folder, const Summary& s) {
  const nlohmann::ordered_json json{
      {"scene", s.scene},
      {"set", s.set},
      {"variant", s.variant},
      {"versions", s.versions},
      {"ending", s.ending},
      {"cells", s.cells},
      {"steps", s.steps},
      {"substeps", s.substeps},
      {"physical_seconds", s.physical_seconds},
      {"wall_seconds", s.wall_seconds},
      {"cpu_seconds", s.cpu_seconds},
      {"mlups", s.mlups},
      {"time_share", s.time_share},
      {"megabytes", s.megabytes},
      {"waiting", s.waiting},
      {"ma_max", s.ma_max},
      {"ma_paper", s.ma_paper},
      {"re", s.re},
      {"re_h", s.re_h},
      {"mass_drift", s.mass_drift},
      {"parameters", s.parameters},
      {"results", nlohmann::json::array()},
  };
  const std::string path = folder + "/summary.json", part = path + ".part";
  {
    std::ofstream out(part);
    out << json.dump(2) << '\n';
    if (!out.flush()) throw InputError(path, "cannot be written", "is the disk full?");
  }
  if (std::rename(part.c_str(), path.c_str()) != 0)
    throw InputError(path, "cannot be replaced", "is the folder writable?");
}

}  // namespace lbm
