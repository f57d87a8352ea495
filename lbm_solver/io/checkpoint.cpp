// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/checkpoint.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "lbm_solver/base/errors.h"
#include "protocol/hdf5_file.h"
#include "protocol/input_file.h"

namespace lbm {

using protocol::hdf5::check;
using protocol::hdf5::Handle;
using protocol::hdf5::Open;

void write_checkpoint(const std::string& path, const State& state) {
  const std::string part = path + ".part";
  {
    const Handle file = protocol::hdf5::open_file(part, Open::Create);
    for (const auto& [name, values] : state) {
      const hsize_t size = values.size();
      const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "make a space");
      const Handle set(H5Dcreate2(file, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT,
                                  H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose, "create " + name);
      check(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "write " + name + " (is the disk full?)");
    }
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush a checkpoint (is the disk full?)");
  }
  const int file = ::open(part.c_str(), O_RDONLY);  // on disk before it takes the old one's place
  if (file >= 0) {
    ::fsync(file);
    ::close(file);
  }
  if (std::rename(part.c_str(), path.c_str()) != 0)
    throw InputError(path, "cannot be replaced", "is the folder writable?");
}

namespace {

herr_t collect(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

Handle open_checkpoint(const std::string& path) {
  if (const std::string problem = protocol::why_unreadable(path); !problem.empty())
    throw InputError(path,
                     std::filesystem::exists(path) ? problem : "no checkpoint to restart from",
                     "run first with run.checkpoint_every in the scene, and the same --out");
  return protocol::hdf5::open_file(path, Open::Read);
}

std::vector<double> read_array(hid_t file, const std::string& name) {
  const Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "open " + name);
  std::vector<double> values(protocol::hdf5::size_that_fits(set, sizeof(double), name));
  check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        "read " + name);
  return values;
}

}  // namespace

State read_checkpoint(const std::string& path) {
  const Handle file = open_checkpoint(path);
  std::vector<std::string> names;
  check(H5Literate(file, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), "list " + path);
  State state;
  for (const std::string& name : names) state[name] = read_array(file, name);
  return state;
}

std::vector<double> read_checkpoint_array(const std::string& path, const std::string& name) {
  const Handle file = open_checkpoint(path);
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return {};
  return read_array(file, name);
}

}  // namespace lbm
