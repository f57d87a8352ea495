// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/time_table_reader.h"

#include <fmt/core.h>

#include <filesystem>
#include <vector>

#include "lbm_solver/io/text_table.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestTimeTable = 256'000'000;  // bytes

}  // namespace

TimeTableScene read_time_table(TableReader& t, const std::string& key, const std::string& repeat,
                               const std::string& scene_file) {
  TimeTableScene table;
  const std::string name = t.text_or(key, "");
  table.repeats = repeat == "periodic";
  if (name.empty() && table.repeats)
    t.fail(key, "is missing, and it is to repeat", "give the table, or leave the repeat out");
  if (name.empty()) return table;
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    t.fail(key, "= \"" + name + "\": " + problem, remedy);
  };
  if (const auto problem = protocol::why_unreadable(path, kLargestTimeTable); !problem.empty())
    fail(problem, "put a table `time,factor` beside the scene");
  t.note(key + "_content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  TextTable file(path);
  if (!file.next() || file.line() != "time,factor")
    fail("begins with '" + file.shown() + "'", "the first line is time,factor (in s and 1)");
  while (file.next()) {
    const std::vector<double> v = file.numbers(2);
    if (v.empty())
      fail(fmt::format("line {}: '{}' is not two finite numbers", file.number(), file.shown()),
           "give time,factor");
    const double time = v[0], factor = v[1];
    if (!table.times.empty() && time <= table.times.back())
      fail(fmt::format("line {}: time {:.6g} s does not come after {:.6g} s", file.number(), time,
                       table.times.back()),
           "sort the lines by time, each time once");
    table.times.push_back(time);
    table.factors.push_back(factor);
  }
  if (table.times.size() < 2) fail("holds fewer than two lines", "give at least two times");
  if (table.repeats && table.factors.front() != table.factors.back())
    fail("repeats, and its last factor is not its first",
         "end with the factor that it begins with");
  return table;
}

}  // namespace lbm
