// SPDX-License-Identifier: MIT
#include "protocol/transport/hdf5_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "protocol/program/input_file.h"

namespace protocol::hdf5 {

Handle::Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
  if (id < 0) throw std::runtime_error("HDF5 failed to " + what);
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw std::runtime_error("HDF5 failed to " + what);
}

namespace {

/// A recording takes the place of another one, but of no other file: a mistyped path loses nothing.
bool is_something_else(const std::string& path) {
  std::error_code none;
  const auto size = std::filesystem::file_size(path, none);
  if (none || size == 0) return false;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT);
  const bool recording = file >= 0 && H5Aexists(file, "trace_version") > 0;
  if (file >= 0) H5Fclose(file);
  return !recording;
}

}  // namespace

Handle open_file(const std::string& path, Open mode) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // our exceptions speak instead of its stack dump
  const bool creates = mode == Open::Create || mode == Open::CreateForReaders;
  if (const auto folder = std::filesystem::path(path).parent_path();
      mode == Open::Append && !folder.empty() && !std::filesystem::exists(folder))
    throw std::runtime_error("cannot open " + path +
                             ": its folder has been moved or deleted; leave it where it is until "
                             "the run has ended");
  if (const std::string problem = why_unreadable(path);
      !problem.empty() && (!creates || std::filesystem::exists(path)))
    throw std::runtime_error("cannot open " + path + ": " + problem + "; give another path");
  if (mode == Open::CreateForReaders && is_something_else(path))
    throw std::runtime_error(path +
                             " is there and no recording: it is not overwritten; give "
                             "another path, or remove it");
  std::FILE* probe = std::fopen(path.c_str(), creates ? "ab" : mode == Open::Append ? "r+b" : "rb");
  if (!probe)
    throw std::runtime_error("cannot open " + path + ": " + std::strerror(errno) +
                             (creates ? "; choose a folder that exists and is writable" : ""));
  std::fclose(probe);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "make access properties");
  if (mode == Open::CreateForReaders || mode == Open::ReadWhileWritten)
    check(H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "set the version");
  const std::string what = "open " + path + " (is it a complete HDF5 file?)";
  switch (mode) {
    case Open::Create:
    case Open::CreateForReaders:
      return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, what};
    case Open::Append:
      return {H5Fopen(path.c_str(), H5F_ACC_RDWR, access), H5Fclose, what};
    case Open::Read:
      return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, what};
    case Open::ReadWhileWritten:
      return {H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access), H5Fclose, what};
  }
  return {};
}

namespace {

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a text type");
  check(H5Tset_size(type, size ? size : 1), "size a text");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "set UTF-8");
  return type;
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar");
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create attribute " + name);
  check(H5Awrite(attribute, type, value), "write attribute " + name);
}

}  // namespace

void set_attribute(hid_t object, const std::string& name, const std::string& text) {
  write_attribute(object, name, text_type(text.size()), text.c_str());
}
void set_attribute(hid_t object, const std::string& name, double value) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, &value);
}
void set_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write_attribute(object, name, H5T_NATIVE_INT64, &value);
}

std::string text_attribute(hid_t object, const std::string& name) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                         "read attribute " + name);
  const Handle type(H5Aget_type(attribute), H5Tclose, "read a type");
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, text.data()), "read attribute " + name);
  text.resize(std::strlen(text.c_str()));
  return text;
}

namespace {

template <class T>
T number_attribute(hid_t object, const std::string& name, hid_t type) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                         "read attribute " + name);
  T value{};
  check(H5Aread(attribute, type, &value), "read attribute " + name);
  return value;
}

}  // namespace

double real_attribute(hid_t object, const std::string& name) {
  return number_attribute<double>(object, name, H5T_NATIVE_DOUBLE);
}
std::int64_t integer_attribute(hid_t object, const std::string& name) {
  return number_attribute<std::int64_t>(object, name, H5T_NATIVE_INT64);
}

std::size_t size_that_fits(hid_t dataset, std::size_t bytes, const std::string& name) {
  std::string path(static_cast<std::size_t>(H5Fget_name(dataset, nullptr, 0)), '\0');
  H5Fget_name(dataset, path.data(), path.size() + 1);
  const Handle space(H5Dget_space(dataset), H5Sclose, "read a space");
  if (H5Sget_simple_extent_ndims(space) != 1)
    throw std::runtime_error(path + " is damaged: " + name + " is no list");
  hsize_t size = 0;
  check(H5Sget_simple_extent_dims(space, &size, nullptr), "read the size of " + name);
  if (size > std::filesystem::file_size(path) / bytes)
    throw std::runtime_error(path + " is damaged: " + name + " claims " + std::to_string(size) +
                             " rows, more than the file can hold");
  return size;
}

}  // namespace protocol::hdf5
