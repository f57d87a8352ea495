// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/grains_reader.h"

#include <fmt/core.h>

#include <filesystem>

#include "lbm_solver/io/text_table.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestGrains = 256'000'000;  // bytes

}  // namespace

void read_grains(TableReader t, const std::string& scene_file, int d,
                 std::vector<ObstacleScene>& obstacles) {
  const std::string name = t.text_or("file", "");
  t.finish();
  if (name.empty()) return;
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  if (const auto problem = protocol::why_unreadable(path, kLargestGrains); !problem.empty())
    t.fail("file", "= \"" + name + "\": " + problem, "put a table of grains beside the scene");
  t.note("content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  TextTable table(path);
  const std::string columns = d == 2 ? "x,y,diameter" : "x,y,z,diameter";
  if (!table.next() || table.line() != columns)
    t.fail("file", "begins with '" + table.shown() + "'",
           "the first line is " + columns + " (in m)");
  while (table.next()) {
    ObstacleScene o;
    o.round = o.grain = true;
    const std::vector<double> v = table.numbers(static_cast<std::size_t>(d) + 1);
    if (v.empty() || !(v.back() > 0.0))
      t.fail("file",
             fmt::format("line {}: '{}' is not {} finite numbers, the last of them positive",
                         table.number(), table.shown(), d + 1),
             "give " + columns + " in m");
    o.centre = {v[0], v[1], d == 3 ? v[2] : 0.0};
    o.diameter = v.back();
    obstacles.push_back(o);
  }
}

}  // namespace lbm
