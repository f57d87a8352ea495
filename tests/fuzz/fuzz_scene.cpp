// SPDX-License-Identifier: GPL-2.0-or-later
/// Any text as a scene: an InputError with a reason, or a scene.
#include <unistd.h>

#include <fstream>
#include <string>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = "/dev/shm/bplbm_fuzz_" + std::to_string(getpid()) + ".toml";
  std::ofstream(path).write(reinterpret_cast<const char*>(data),
                            static_cast<std::streamsize>(size));
  try {
    lbm::read_scene({path});
  } catch (const lbm::InputError& e) {
    if (std::string(e.what()).empty()) __builtin_trap();
  }
  unlink(path.c_str());
  return 0;
}
