// SPDX-License-Identifier: GPL-2.0-or-later
/// Any text in any place of a scene whose text reaches the solid's script, or looks as if it could:
/// an InputError, or a value that is one word in every line of a script.
#include <unistd.h>

#include <array>
#include <fstream>
#include <string>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/script_variables.h"
#include "tests/support/script_words.h"

namespace {

constexpr std::array kPlaces{"name",     "value",     "title",     "sides_x",
                             "schedule", "collision", "solid_term"};

/// As a basic string of TOML, whatever it holds.
std::string quoted(const std::string& text) {
  static constexpr const char* kHex = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 32 || byte == 127 || c == '"' || c == '\\')
      out += std::string("\\u00") + kHex[byte / 16] + kHex[byte % 16];
    else
      out += c;
  }
  return out + '"';
}

std::string scene(std::size_t place, const std::string& text) {
  const auto at = [&](const char* which, const std::string& otherwise) {
    return quoted(which == std::string(kPlaces[place]) ? text : otherwise);
  };
  return "title = " + at("title", "t") +
         "\n[box]\nsize = [0.02, 0.06]\nsides_x = " + at("sides_x", "wall") +
         "\n[fluid]\ndensity = 1000.0\nkinematic_viscosity = 1e-5\nvelocity_scale = 0.06\n"
         "[particles]\ndiameter = 0.0025\ndensity = 1250.0\n[particles.variables]\n" +
         at("name", "v") + " = " + at("value", "1") + "\n[numerics]\ncells_per_diameter = 5\n" +
         "collision = " + at("collision", "trt") +
         "\nsolid_term = " + at("solid_term", "resistance") +
         "\n[coupling]\nsubsteps = 10\nschedule = " + at("schedule", "serial") +
         "\n[run]\nend_time = 1.0\n";
}

}  // namespace

/// The first byte chooses the place.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (lbm::why_no_script_path(text).empty() && !text.empty() &&
      text.find('\0') == std::string::npos && !test::is_whole_between_quotes(text))
    __builtin_trap();
  static const std::string path =
      "/dev/shm/bplbm_fuzz_script_" + std::to_string(getpid()) + ".toml";
  std::ofstream(path) << scene(data[0] % kPlaces.size(), text);
  try {
    const lbm::Scene read = lbm::read_scene({path});
    for (const auto& [name, value] : read.particles->variables)
      if (!test::is_one_word_in_scripts(name) || !test::is_one_word_in_scripts(value))
        __builtin_trap();
  } catch (const lbm::InputError&) {
  }
  unlink(path.c_str());
  return 0;
}
