// SPDX-License-Identifier: GPL-2.0-or-later
/// Arrays of a file for ParaView and Python, each with its unit.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include "protocol/transport/hdf5_file.h"

namespace lbm {

/// Writes an array of float, double or int into a group of an HDF5 file.
/// @param unit  of the numbers, or of each column
/// @param columns  of a table, their names
/// @throws std::runtime_error  it cannot be written
template <class T>
void write_array(hid_t group, const char* name, const std::vector<T>& data,
                 const std::vector<hsize_t>& shape, const char* unit,
                 const char* columns = nullptr) {
  const hid_t type = std::is_same_v<T, int>     ? H5T_NATIVE_INT
                     : std::is_same_v<T, float> ? H5T_NATIVE_FLOAT
                                                : H5T_NATIVE_DOUBLE;
  const protocol::hdf5::Handle space(
      H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
      "make a space");
  const protocol::hdf5::Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
  protocol::hdf5::check(H5Pset_obj_track_times(how, 0), "set properties");  // as in cell_set.cpp
  const protocol::hdf5::Handle set(
      H5Dcreate2(group, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT), H5Dclose,
      std::string("create ") + name);
  protocol::hdf5::set_attribute(set, columns ? "units" : "unit", std::string(unit));
  if (columns) protocol::hdf5::set_attribute(set, "columns", std::string(columns));
  if (data.empty()) return;
  protocol::hdf5::check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()),
                        std::string("write ") + name + " (is the disk full?)");
}

}  // namespace lbm
