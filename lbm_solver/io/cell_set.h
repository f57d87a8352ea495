// SPDX-License-Identifier: GPL-2.0-or-later
/// Numbers of every cell of the box in a file, which come and go a piece at a time.
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/cell_values.h"
#include "lbm_solver/field/decomposition.h"
#include "lbm_solver/io/cell_fields.h"
#include "protocol/transport/hdf5_file.h"

namespace lbm {

/// How the cells lie in a data set: [z][y][x], in two dimensions [y][x], and a further axis for
/// more components than 0.
struct CellLayout {
  Cell3 box{0, 0, 0};
  int dimension = 3, components = 0;

  std::vector<hsize_t> of(const Cell3& cells, hsize_t last) const;
  std::vector<hsize_t> shape() const { return of(box, static_cast<hsize_t>(components)); }
};

/// A data set of such a layout, open.
class CellSet {
 public:
  /// Makes one. @param file_type  of its numbers there
  CellSet(hid_t group, const std::string& name, hid_t file_type, const CellLayout& layout);
  hid_t id() const { return set_; }
  /// @param type  of the numbers in memory, [z][y][x][components]
  void write(const CellRange& piece, hid_t type, const void* numbers) const;

 private:
  const std::string name_;
  const CellLayout layout_;
  protocol::hdf5::Handle space_, set_;
};

/// Values of cells as a data set of four dimensions, [z][y][x][components], doubles or floats. Rank
/// 0 writes, others send: the group means nothing there. Collective.
/// @param ranks  null: there is one
void write_values(hid_t group, const std::string& name, const CellValues& values,
                  const Decomposition* ranks);
/// Values that lie in such a data set: each piece is read when it is asked for, from the file of
/// that path. @param inside  path of the data set in it
/// @throws std::runtime_error  it is none, or larger than its file
CellValues values_in(hid_t set, const std::string& path, const std::string& inside);
/// Whether a data set has four dimensions.
bool has_cells(hid_t set);

/// Writes fields into a group, each with its unit. Rank 0 writes, others send: the group means
/// nothing there. Collective.
void write_fields(hid_t group, const CellFields& fields, int dimension, const Decomposition& ranks);

}  // namespace lbm
