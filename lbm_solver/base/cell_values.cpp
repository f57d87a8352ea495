// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/cell_values.h"

#include <algorithm>
#include <memory>

namespace lbm {
namespace {

constexpr std::size_t kPiece = std::size_t{4} << 20;  // bytes

std::vector<double> all_of(const CellValues& values) {
  std::vector<double> list(values.here.count() * static_cast<std::size_t>(values.components));
  values.read(values.here, list);
  return list;
}

}  // namespace

bool CellRange::holds(const CellRange& other) const {
  for (int a = 0; a < 3; ++a)
    if (other.begin[a] < begin[a] || other.begin[a] + other.size[a] > begin[a] + size[a])
      return false;
  return true;
}

std::vector<CellRange> pieces_of(const CellRange& range, std::size_t bytes_a_cell) {
  std::vector<CellRange> pieces;
  const auto [nx, ny, nz] = range.size;
  const std::size_t row = std::max<std::size_t>(1, bytes_a_cell * static_cast<std::size_t>(nx));
  const auto rows = static_cast<int>(std::clamp<std::size_t>(kPiece / row, 1, 1 << 20));
  const int layers = std::max(1, rows / std::max(1, ny)), lines = std::min(rows, ny);
  for (int z = 0; z < nz; z += layers)
    for (int y = 0; y < ny; y += lines)
      pieces.push_back({{range.begin[0], range.begin[1] + y, range.begin[2] + z},
                        {nx, std::min(lines, ny - y), std::min(layers, nz - z)}});
  return pieces;
}

CellValues CellValues::kept() const {
  CellValues other = *this;
  const auto list = std::make_shared<const std::vector<double>>(all_of(*this));
  other.read = [list, cells = here, n = static_cast<std::size_t>(components)](
                   const CellRange& piece, std::span<double> to) {
    piece.each([&](const Cell3& c, std::size_t number) {
      const std::size_t row = static_cast<std::size_t>(c[2] - cells.begin[2]) * cells.size[1] +
                              static_cast<std::size_t>(c[1] - cells.begin[1]);
      const std::size_t at = row * cells.size[0] + static_cast<std::size_t>(c[0] - cells.begin[0]);
      std::copy_n(list->begin() + static_cast<std::ptrdiff_t>(at * n), n,
                  to.begin() + static_cast<std::ptrdiff_t>(number * n));
    });
  };
  return other;
}

bool operator==(const CellValues& a, const CellValues& b) {
  return a.box == b.box && a.components == b.components && a.here.begin == b.here.begin &&
         a.here.size == b.here.size && all_of(a) == all_of(b);
}

}  // namespace lbm
