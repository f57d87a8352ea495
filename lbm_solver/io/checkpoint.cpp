// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/checkpoint.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/cell_set.h"
#include "lbm_solver/io/hdf5_files.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"
#include "protocol/transport/hdf5_file.h"

namespace lbm {

using protocol::hdf5::check;
using protocol::hdf5::Handle;
using protocol::hdf5::Open;

namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 8;  // parts of parts of …
constexpr const char* kAsNoOther = "start again without --restart";

// ---- the line behind the HDF5 file
// ---------------------------------------------------------------

constexpr const char* kSealBegin = "\nBPLBM checkpoint 1 interval ";
constexpr std::size_t kSealLength = 29 + 20 + 7 + 20 + 7 + 8 + 1;

/// All of the line that its checksum covers.
std::string seal_text(std::int64_t interval, std::uint64_t bytes) {
  return fmt::format("{}{:020} bytes {:020} crc32 ", kSealBegin, interval, bytes);
}

std::string sealed(const std::string& text, std::uint32_t crc_before) {
  const auto bytes = std::as_bytes(std::span(text));
  return fmt::format("{}{:08x}\n", text, protocol::crc32(bytes, crc_before));
}

/// Why a file is no whole checkpoint; empty where it is.
std::string why_damaged(const std::string& path) {
  const std::uintmax_t size = fs::file_size(path);
  std::string line(kSealLength, ' ');
  std::ifstream file(path, std::ios::binary);
  if (size > kSealLength) {
    file.seekg(static_cast<std::streamoff>(size - kSealLength));
    file.read(line.data(), static_cast<std::streamsize>(kSealLength));
  }
  if (!line.starts_with(kSealBegin))
    return "is cut off or damaged at its end, of an earlier version, or no checkpoint";
  const auto found = protocol::fingerprint(path, size - kSealLength);
  const std::string text = line.substr(0, kSealLength - 9);
  if (line == sealed(text, found.crc)) return {};
  return "is damaged: its content does not have the checksum that it had when it was written";
}

// ---- a record as an HDF5 group
// -------------------------------------------------------------------

void write_data(hid_t group, const std::string& name, hid_t type, hid_t space, const void* data) {
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
  check(H5Pset_obj_track_times(how, 0), "set properties");  // equal states are equal files
  const Handle set(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT),
                   H5Dclose, "create " + name);
  check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data),
        "write " + name + " (is the disk full?)");
}

struct ValueWriter {
  hid_t group;
  const std::string& name;

  void operator()(std::int64_t value) const { protocol::hdf5::set_attribute(group, name, value); }
  void operator()(double value) const { protocol::hdf5::set_attribute(group, name, value); }
  void operator()(const std::string& text) const {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
    check(H5Tset_size(type, text.size() + 1), "size a text");
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
    write_data(group, name, type, space, text.c_str());
  }
  void operator()(const std::vector<double>& list) const { write(H5T_NATIVE_DOUBLE, list); }
  void operator()(const std::vector<std::int64_t>& list) const { write(H5T_NATIVE_INT64, list); }

 private:
  template <class T>
  void write(hid_t type, const std::vector<T>& list) const {
    const hsize_t size = list.size();
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "make a space");
    write_data(group, name, type, space, list.data());
  }
};

void write_record(hid_t group, const Record& record, const Decomposition* ranks) {
  for (const auto& [name, value] : record.values()) std::visit(ValueWriter{group, name}, value);
  for (const auto& [name, values] : record.cells()) write_values(group, name, values, ranks);
  for (const auto& [name, part] : record.parts()) {
    const Handle inner(H5Gcreate2(group, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Gclose, "create " + name);
    write_record(inner, part, ranks);
  }
}

/// What other ranks do meanwhile.
void send_cells(const Record& record, const Decomposition* ranks) {
  for (const auto& [name, values] : record.cells()) write_values(-1, name, values, ranks);
  for (const auto& [name, part] : record.parts()) send_cells(part, ranks);
}

herr_t collect_link(hid_t, const char* name, const H5L_info_t* info, void* names) {
  if (info->type == H5L_TYPE_HARD)  // others may lead to other files
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}
herr_t collect_attribute(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

template <class T>
std::vector<T> read_list(hid_t set, hid_t type, const std::string& name) {
  std::vector<T> list(protocol::hdf5::size_that_fits(set, sizeof(T), name));
  check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, list.data()), "read " + name);
  return list;
}

std::string read_text(hid_t set, hid_t type, const std::string& name, std::uintmax_t most) {
  const Handle space(H5Dget_space(set), H5Sclose, "read a space");
  const std::size_t size = H5Tget_size(type);
  if (H5Tis_variable_str(type) != 0 || H5Sget_simple_extent_npoints(space) != 1 || size > most)
    throw std::runtime_error(name + " is no text");
  std::string text(size, '\0');
  check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read " + name);
  text.resize(text.find('\0') == std::string::npos ? size : text.find('\0'));
  return text;
}

Record::Value read_data(hid_t set, const std::string& name, std::uintmax_t most) {
  const Handle type(H5Dget_type(set), H5Tclose, "read the type of " + name);
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return read_list<std::int64_t>(set, H5T_NATIVE_INT64, name);
    case H5T_FLOAT:
      return read_list<double>(set, H5T_NATIVE_DOUBLE, name);
    case H5T_STRING:
      return read_text(set, type, name, most);
    default:
      throw std::runtime_error(name + " is neither numbers nor text");
  }
}

Record::Value read_number(hid_t group, const std::string& name) {
  const Handle attribute(H5Aopen(group, name.c_str(), H5P_DEFAULT), H5Aclose, "open " + name);
  const Handle space(H5Aget_space(attribute), H5Sclose, "read a space");
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a type");
  const H5T_class_t kind = H5Tget_class(type);
  if (H5Sget_simple_extent_npoints(space) != 1 || (kind != H5T_INTEGER && kind != H5T_FLOAT))
    throw std::runtime_error(name + " is no number");
  if (kind == H5T_FLOAT) return protocol::hdf5::real_attribute(group, name);
  return protocol::hdf5::integer_attribute(group, name);
}

struct RecordReader {
  const std::string& path;
  std::uintmax_t most;  // bytes of the file

  /// @param inside  path of the group in the file, with a slash behind it
  Record read(hid_t group, const std::string& inside, int depth) const {
    if (depth > kDeepest) throw std::runtime_error("its parts lie too deep");
    Record record;
    std::vector<std::string> names;
    check(H5Aiterate2(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_attribute, &names),
          "list its numbers");
    for (const std::string& name : names) record.set(name, read_number(group, name));
    names.clear();
    check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_link, &names),
          "list its parts");
    for (const std::string& name : names) {
      H5O_info_t info;
      check(H5Oget_info_by_name(group, name.c_str(), &info, H5P_DEFAULT), "look at " + name);
      if (info.type == H5O_TYPE_GROUP) {
        const Handle part(H5Gopen2(group, name.c_str(), H5P_DEFAULT), H5Gclose, "open " + name);
        record.set(name, read(part, inside + name + "/", depth + 1));
        continue;
      }
      const Handle set(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "open " + name);
      if (has_cells(set))
        record.set(name, values_in(set, path, inside + name));
      else
        record.set(name, read_data(set, name, most));
    }
    return record;
  }
};

/// On disk before it takes the place of another one.
void flush_to_disk(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

/// Gives the file a second name at once: at every moment there is a checkpoint under the first one.
void keep_as(const std::string& path, const std::string& before) {
  std::error_code failed;
  if (!fs::exists(path)) return;
  const std::string link = before + ".part";
  fs::remove(link, failed);
  fs::create_hard_link(path, link, failed);
  if (failed) fs::copy_file(path, link, failed);  // a file system without links
  if (!failed) fs::rename(link, before, failed);
  if (failed)
    throw InputError(before, "cannot be written: " + failed.message(), "is the folder writable?");
}

}  // namespace

bool has_hdf5() {
  return true;
}

void write_checkpoint(const std::string& path, const Record& record, std::int64_t interval,
                      const std::string& before, const Decomposition* ranks) {
  if (ranks && ranks->rank() != 0) return send_cells(record, ranks);
  const std::string part = path + ".part";
  {
    const Handle file = protocol::hdf5::open_file(part, Open::Create);
    write_record(file, record, ranks);
    check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush a checkpoint (is the disk full?)");
  }
  const auto content = protocol::fingerprint(part);
  std::ofstream out(part, std::ios::binary | std::ios::app);
  out << sealed(seal_text(interval, content.bytes), content.crc);
  out.close();
  if (!out) throw InputError(part, "cannot be written", "is the disk full?");
  flush_to_disk(part);
  if (!before.empty()) keep_as(path, before);
  if (std::rename(part.c_str(), path.c_str()) != 0)
    throw InputError(path, "cannot be replaced", "is the folder writable?");
}

Record read_record(const std::string& path) {
  const Handle file = protocol::hdf5::open_file(path, Open::Read);
  return RecordReader{path, fs::file_size(path)}.read(file, "/", 0);
}

Record read_checkpoint(const std::string& path) {
  if (const std::string problem = protocol::why_unreadable(path); !problem.empty())
    throw InputError(path, fs::exists(path) ? problem : "no checkpoint to restart from",
                     "run first with run.checkpoint_every in the scene, and the same --out");
  if (const std::string problem = why_damaged(path); !problem.empty())
    throw InputError(path, problem, kAsNoOther);
  try {
    return read_record(path);
  } catch (const std::runtime_error& error) {
    throw InputError(path, fmt::format("cannot be read: {}", error.what()), kAsNoOther);
  }
}

}  // namespace lbm
