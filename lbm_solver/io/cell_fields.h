// SPDX-License-Identifier: GPL-2.0-or-later
/// What is shown of every cell, before it goes to a file.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lbm_solver/field/decomposition.h"

namespace lbm {

/// One of the fields that are written together.
struct CellField {
  const char *name, *unit;
  int components = 1;
};
/// What is shown of every cell, in single precision.
struct CellFields {
  std::vector<CellField> fields;
  /// Fills the numbers of a piece of this rank's cells, one field after another, each
  /// [z][y][x][components].
  std::function<void(const CellRange&, std::span<float>)> make;

  bool has(const std::string& name) const;
  /// Numbers of a cell.
  int components() const;
};

/// What the other ranks do while the first one writes fields. Collective.
void send_fields(const CellFields& fields, const Decomposition& ranks);

}  // namespace lbm
