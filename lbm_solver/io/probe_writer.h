// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdio>
#include <memory>
#include <span>
#include <string>

#include "protocol/session.h"

namespace lbm {

/// Appends one line a particle to `probes.csv`: its motion at the beginning of an interval and the
/// load it received over it. SI units.
class ProbeWriter {
 public:
  explicit ProbeWriter(const std::string& folder);
  /// @param loads  same order as the particles; empty at the last state
  void write(double time, std::span<const protocol::Particle> particles,
             std::span<const protocol::Load> loads);

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace lbm
