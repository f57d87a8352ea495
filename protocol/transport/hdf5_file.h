// SPDX-License-Identifier: MIT
/// A thin owner of HDF5 identifiers and files: errors become exceptions, nothing leaks.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace protocol::hdf5 {

/// An HDF5 identifier and the function that closes it.
class Handle {
 public:
  Handle() = default;
  /// @throws std::runtime_error naming `what` where HDF5 returned an error
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what);
  Handle(Handle&& other) noexcept { swap(other); }
  Handle& operator=(Handle&& other) noexcept {
    Handle(std::move(other)).swap(*this);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  void swap(Handle& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
  }
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// @throws std::runtime_error naming `what` where an HDF5 call failed
void check(herr_t status, const std::string& what);

/// CreateForReaders: may be read while it is written (SWMR), but is marked as open meanwhile, and
/// after a kill only ReadWhileWritten opens it. Create, Append: no mark; what was closed stays
/// readable.
enum class Open { Create, CreateForReaders, Append, Read, ReadWhileWritten };

/// @throws std::runtime_error with the path and a reason a user can act on
Handle open_file(const std::string& path, Open mode);

/// Rows of a list of one dimension, each of so many bytes.
/// @throws std::runtime_error  its file is too small for them: it is damaged
std::size_t size_that_fits(hid_t dataset, std::size_t bytes, const std::string& name);

void set_attribute(hid_t object, const std::string& name, const std::string& text);
void set_attribute(hid_t object, const std::string& name, double value);
void set_attribute(hid_t object, const std::string& name, std::int64_t value);
std::string text_attribute(hid_t object, const std::string& name);
double real_attribute(hid_t object, const std::string& name);
std::int64_t integer_attribute(hid_t object, const std::string& name);

}  // namespace protocol::hdf5
