// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "tests/support/job.h"

namespace test {

/// The text of the settling disc's scene, to be changed by a test.
inline std::string good_scene() {
  return read_file(BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml");
}

}  // namespace test
