// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/profile_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "lbm_solver/io/text_table.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestProfile = 256'000'000;  // bytes
constexpr const char* kKey = "profile_table";

/// Places along the side's axes, those that the file names, and factors.
struct Lines {
  std::vector<int> axes;  ///< of the side, 0 or 1, one a column
  std::map<std::array<double, 2>, double> factors;
};

/// Which of the side's axes the first line of a file names. @return empty: none that it could
std::vector<int> axes_of(const std::string& head, SideName side, int dimension) {
  const std::string first(1, "xyz"[axis_along(side, 0)]), second(1, "xyz"[axis_along(side, 1)]);
  if (head == first + ",factor") return {0};
  if (dimension == 3 && head == second + ",factor") return {1};
  if (dimension == 3 && head == first + "," + second + ",factor") return {0, 1};
  return {};
}

Lines read_lines(TextTable& file, std::vector<int> axes, const auto& fail) {
  Lines lines{std::move(axes), {}};
  const std::size_t places = lines.axes.size();
  while (file.next()) {
    const std::vector<double> v = file.numbers(places + 1);
    if (v.empty())
      fail(fmt::format("line {}: '{}' is not {} finite numbers", file.number(), file.shown(),
                       places + 1),
           "give a place on each axis [m] and the factor");
    std::array<double, 2> at{0.0, 0.0};
    for (std::size_t k = 0; k < places; ++k) at[lines.axes[k]] = v[k];
    if (!lines.factors.emplace(at, v[places]).second)
      fail(fmt::format("line {}: '{}' has the place of an earlier line", file.number(),
                       file.shown()),
           "give each place once");
  }
  return lines;
}

ProfileScene grid_of(const Lines& lines, const auto& fail) {
  ProfileScene profile;
  for (const int axis : lines.axes) {
    std::vector<double>& places = profile.places[axis];
    for (const auto& [at, factor] : lines.factors) places.push_back(at[axis]);
    std::ranges::sort(places);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (places.size() < 2) fail("has fewer than two places along an axis", "give at least two");
  }
  const auto count = [&](int axis) {
    return std::max<std::size_t>(1, profile.places[axis].size());
  };
  if (count(0) * count(1) != lines.factors.size())
    fail(fmt::format("has {} lines, and {} × {} places along its axes", lines.factors.size(),
                     count(0), count(1)),
         "give a factor at every place of a grid");
  for (std::size_t t = 0; t < count(1); ++t)
    for (std::size_t s = 0; s < count(0); ++s) {
      std::array<double, 2> at{0.0, 0.0};
      if (!profile.places[0].empty()) at[0] = profile.places[0][s];
      if (!profile.places[1].empty()) at[1] = profile.places[1][t];
      profile.factors.push_back(lines.factors.at(at));
    }
  return profile;
}

}  // namespace

ProfileScene read_profile(TableReader& t, SideName side, int dimension,
                          const std::string& scene_file) {
  const std::string name = t.text_or("profile_table", "");
  if (name.empty()) return {};
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    t.fail(kKey, "= \"" + name + "\": " + problem, remedy);
  };
  if (const auto problem = protocol::why_unreadable(path, kLargestProfile); !problem.empty())
    fail(problem, "put a table of factors beside the scene");
  t.note(std::string(kKey) + "_content",
         fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  TextTable file(path);
  file.next();
  const std::string along(1, "xyz"[axis_along(side, 0)]);
  const std::vector<int> axes = axes_of(file.line(), side, dimension);
  if (axes.empty())
    fail("begins with '" + file.shown() + "'",
         dimension == 2 ? "the first line is " + along + ",factor (in m and 1)"
                        : fmt::format("the first line is {0},factor, {1},factor or {0},{1},factor "
                                      "(in m and 1)",
                                      along, "xyz"[axis_along(side, 1)]));
  return grid_of(read_lines(file, axes, fail), fail);
}

}  // namespace lbm
