// SPDX-License-Identifier: GPL-2.0-or-later
/// Fields, averages, checkpoints, recordings and .h5 images are files of HDF5, and without HDF5
/// (BPLBM_HDF5=OFF in CMake) lbm refuses what asks for them.
#pragma once

namespace lbm {

/// Whether this lbm was built with HDF5.
bool has_hdf5();

inline constexpr const char* kNeedsHdf5 = "needs HDF5, without which this lbm was built";
inline constexpr const char* kWithoutHdf5 =
    "leave it out, or build lbm with HDF5 (cmake -DBPLBM_HDF5=ON)";

/// Where @p wanted: fails, as a reader of a scene does, at a key.
template <class Table>
void expect_hdf5(const Table& table, const char* key, bool wanted) {
  if (wanted && !has_hdf5()) table.fail(key, kNeedsHdf5, kWithoutHdf5);
}

}  // namespace lbm
