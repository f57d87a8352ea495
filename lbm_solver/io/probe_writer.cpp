// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/probe_writer.h"

#include <fmt/format.h>

#include "lbm_solver/base/errors.h"

namespace lbm {

ProbeWriter::ProbeWriter(const std::string& folder)
    : file_(std::fopen((folder + "/probes.csv").c_str(), "w")) {
  if (!file_) throw InputError(folder + "/probes.csv", "cannot be written", "choose another --out");
  fmt::print(file_.get(), "time,id,x,y,vx,vy,omega,fx,fy,torque\n");
}

void ProbeWriter::write(double time, std::span<const protocol::Particle> particles,
                        std::span<const protocol::Load> loads) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const protocol::State& s = particles[i].state;
    fmt::print(file_.get(), "{:.12g},{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g}", time, s.id,
               s.x[0], s.x[1], s.v[0], s.v[1], s.omega[2]);
    if (loads.empty())
      fmt::print(file_.get(), ",nan,nan,nan\n");
    else
      fmt::print(file_.get(), ",{:.12g},{:.12g},{:.12g}\n", loads[i].force[0], loads[i].force[1],
                 loads[i].torque[2]);
  }
  std::fflush(file_.get());
}

}  // namespace lbm
