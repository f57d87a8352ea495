// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "tests/support/job.h"

namespace test {

/// The text of the settling disc's scene, to be changed by a test.
inline std::string good_scene() {
  return read_file(BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml");
}

/// A periodic box of 10 × 8 cells with a fluid alone, whose step is a millisecond.
/// @param drive  more keys of [fluid] @param rest  tables after [run]
inline std::string small_fluid(const std::string& end_time, const std::string& drive = "",
                               const std::string& rest = "") {
  return R"(
[box]
size = [0.1, 0.08]
sides_x = "periodic"
sides_y = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 0.02
velocity_scale = 0.1
)" + drive +
         R"([numerics]
cell = 0.01
time_step = 0.001
[run]
end_time = )" +
         end_time + "\n" + rest;
}

}  // namespace test
