// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/stl_file.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/refusal.h"

namespace lbm {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50;  // bytes of a binary file
constexpr double kSame = 1e-6;                    // of the mesh's size

/// Three corners a facet.
using Corners = std::vector<Vec3>;

Corners read_binary(const std::string& bytes) {
  Corners corners;
  for (std::size_t at = kHeader; at < bytes.size(); at += kFacet)
    for (int corner = 1; corner <= 3; ++corner) {  // the normal comes first
      std::array<float, 3> x;
      std::memcpy(x.data(), &bytes[at + corner * sizeof x], sizeof x);
      corners.emplace_back(x[0], x[1], x[2]);
    }
  return corners;
}

Corners read_ascii(const std::string& text) {
  Corners corners;
  std::istringstream lines(text);
  std::string line, word, x, y, z;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word) || word != "vertex") continue;
    const bool three = static_cast<bool>(words >> x >> y >> z);
    char* end = nullptr;
    const auto real = [&](const std::string& number_text) {
      const double value = std::strtod(number_text.c_str(), &end);
      return *end == 0 ? std::optional(value) : std::nullopt;
    };
    const auto a = three ? real(x) : std::nullopt, b = three ? real(y) : std::nullopt,
               c = three ? real(z) : std::nullopt;
    if (!a || !b || !c)
      refuse(fmt::format("line {}: '{}' is no vertex", number, line.substr(0, 60)),
             "give 'vertex x y z'");
    corners.emplace_back(*a, *b, *c);
  }
  return corners;
}

/// One vertex where corners lie together.
TriangleMesh joined(const Corners& corners) {
  Vec3 low = corners.front(), high = low;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!std::isfinite(corners[i].sum()))
      refuse(fmt::format("facet {} has a corner at ({}, {}, {})", i / 3 + 1, corners[i].x(),
                         corners[i].y(), corners[i].z()),
             "give finite numbers");
    low = low.cwiseMin(corners[i]);
    high = high.cwiseMax(corners[i]);
  }
  const double grid = kSame * (high - low).maxCoeff();
  if (!(grid > 0.0)) refuse("is a point", "give a surface");
  TriangleMesh mesh;
  std::map<std::array<std::int64_t, 3>, std::uint32_t> numbers;
  std::vector<std::uint32_t> vertex;
  for (const Vec3& corner : corners) {
    std::array<std::int64_t, 3> key;
    for (int a = 0; a < 3; ++a) key[a] = std::llround((corner[a] - low[a]) / grid);
    const auto [at, is_new] =
        numbers.emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(corner);
    vertex.push_back(at->second);
  }
  for (std::size_t i = 0; i < vertex.size(); i += 3) {
    const TriangleMesh::Triangle t{vertex[i], vertex[i + 1], vertex[i + 2]};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace

TriangleMesh read_stl(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream all;
  all << file.rdbuf();
  const std::string bytes = all.str();
  std::uint32_t facets = 0;
  if (bytes.size() >= kHeader) std::memcpy(&facets, &bytes[kHeader - sizeof facets], sizeof facets);
  const bool binary = bytes.size() == kHeader + kFacet * facets && facets > 0;
  const bool ascii =
      !binary && bytes.find("facet") != std::string::npos && bytes.find('\0') == std::string::npos;
  if (!binary && !ascii)
    refuse(bytes.size() < kHeader
               ? fmt::format("has {} bytes and no 'facet'", bytes.size())
               : fmt::format("has {} bytes where its header announces {} facets, {} bytes",
                             bytes.size(), facets, kHeader + kFacet * facets),
           "give a whole .stl file, binary or ASCII");
  const Corners corners = binary ? read_binary(bytes) : read_ascii(bytes);
  if (corners.empty() || corners.size() % 3 != 0)
    refuse(fmt::format("holds {} corners, which are no triangles", corners.size()),
           "give three a facet");
  return joined(corners);
}

void write_stl(const std::string& path, const TriangleMesh& mesh) {
  std::string text = "solid mesh\n";
  for (const auto& t : mesh.triangles) {
    const Vec3 normal = mesh.area_vector(t).normalized();
    text += fmt::format("facet normal {:.9g} {:.9g} {:.9g}\n outer loop\n", normal.x(), normal.y(),
                        normal.z());
    for (const auto v : t) {
      const Vec3& x = mesh.vertices[v];
      text += fmt::format("  vertex {:.17g} {:.17g} {:.17g}\n", x.x(), x.y(), x.z());
    }
    text += " endloop\nendfacet\n";
  }
  text += "endsolid mesh\n";
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw InputError(path, "cannot be written", "is the disk full?");
}

}  // namespace lbm
