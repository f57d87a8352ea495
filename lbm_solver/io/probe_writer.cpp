// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/probe_writer.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <vector>

#include "lbm_solver/base/errors.h"

namespace lbm {

CsvWriter::CsvWriter(const std::string& path, const std::string& columns, double keep_until) {
  std::vector<std::string> kept;
  if (keep_until > 0.0) {
    std::ifstream before(path);
    std::string line;
    std::getline(before, line);  // the columns
    while (std::getline(before, line))
      if (std::strtod(line.c_str(), nullptr) < keep_until) kept.push_back(line);
  }
  file_.reset(std::fopen(path.c_str(), "w"));
  if (!file_) throw InputError(path, "cannot be written", "choose another --out");
  fmt::print(file_.get(), "{}\n", columns);
  for (const std::string& line : kept) fmt::print(file_.get(), "{}\n", line);
}

void CsvWriter::row(std::initializer_list<double> values) {
  const char* separator = "";
  for (const double v : values) {
    fmt::print(file_.get(), "{}{:.12g}", separator, v);
    separator = ",";
  }
  fmt::print(file_.get(), "\n");
}

ProbeWriter::ProbeWriter(const std::string& folder, double keep_until)
    : table_(folder + "/probes.csv", "time,id,x,y,vx,vy,omega,fx,fy,torque", keep_until) {}

void ProbeWriter::write(double time, std::span<const protocol::Particle> particles,
                        std::span<const protocol::Load> loads) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const protocol::State& s = particles[i].state;
    const protocol::Load load =
        loads.empty() ? protocol::Load{s.id, {none, none, none}, {none, none, none}} : loads[i];
    table_.row({time, static_cast<double>(s.id), s.x[0], s.x[1], s.v[0], s.v[1], s.omega[2],
                load.force[0], load.force[1], load.torque[2]});
  }
  table_.flush();
}

}  // namespace lbm
