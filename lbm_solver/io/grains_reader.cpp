// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/grains_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestTable = 256'000'000;  // bytes

}  // namespace

void read_grains(TableReader t, const std::string& scene_file, int d,
                 std::vector<ObstacleScene>& obstacles) {
  const std::string name = t.text_or("file", "");
  t.finish();
  if (name.empty()) return;
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  if (const auto problem = protocol::why_unreadable(path, kLargestTable); !problem.empty())
    t.fail("file", "= \"" + name + "\": " + problem, "put a table of grains beside the scene");
  t.note("content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  std::ifstream table(path);
  std::string line;
  std::getline(table, line);
  const std::string columns = d == 2 ? "x,y,diameter" : "x,y,z,diameter";
  const auto beginning = [&line] { return line.size() > 60 ? line.substr(0, 60) + "…" : line; };
  if (line != columns)
    t.fail("file", "begins with '" + beginning() + "'", "the first line is " + columns + " (in m)");
  for (int number = 2; std::getline(table, line); ++number) {
    ObstacleScene o;
    o.round = o.grain = true;
    char rest = 0;
    double v[4] = {0.0, 0.0, 0.0, 0.0};
    const int read =
        d == 2 ? std::sscanf(line.c_str(), "%lf,%lf,%lf%c", v, v + 1, v + 3, &rest)
               : std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf%c", v, v + 1, v + 2, v + 3, &rest);
    const bool finite = std::isfinite(v[0] + v[1] + v[2] + v[3]);
    if (read != d + 1 || !finite || !(v[3] > 0.0))
      t.fail("file",
             fmt::format("line {}: '{}' is not {} finite numbers, the last of them positive",
                         number, beginning(), d + 1),
             "give " + columns + " in m");
    o.centre = {v[0], v[1], v[2]};
    o.diameter = v[3];
    obstacles.push_back(o);
  }
}

}  // namespace lbm
