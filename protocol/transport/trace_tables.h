// SPDX-License-Identifier: MIT
/// The rows of a trace file and the growing HDF5 tables that hold them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "protocol/transport/hdf5_file.h"
#include "protocol/wire/codec.h"

namespace protocol {

enum class Direction : std::uint32_t { Sent = 0, Received = 1 };

/// One frame: where its records lie in the tables. Frames other than states and loads lie whole in
/// the byte table.
struct FrameRow {
  std::int64_t interval = -1;
  double time = 0.0;
  double wall_clock = 0.0;  ///< seconds since the recording began
  Direction direction = Direction::Sent;
  Kind kind = Kind::Hello;
  std::int32_t remote = 0;
  std::uint32_t flags = 0;
  std::uint64_t first = 0, count = 0;              ///< rows of states or loads, or bytes
  std::uint64_t shape_first = 0, shape_count = 0;  ///< rows of shapes
  Setting setting;                                 ///< of states
};

/// HDF5 type of a row. @return an owned compound type
template <class Row>
hdf5::Handle row_type();

/// A one-dimensional table that grows at its end and can be read while it does (SWMR).
template <class Row>
class Table {
 public:
  /// @param chunk  rows that take their place in the file together
  static Table create(hid_t file, const std::string& name, std::uint64_t chunk = 4096);
  static Table open(hid_t file, const std::string& name);

  void append(std::span<const Row> rows);  ///< buffered
  void flush();                            ///< to disk
  std::uint64_t size() const { return stored_ + pending_.size(); }
  std::vector<Row> read_all() const;

 private:
  Table(hdf5::Handle data, hdf5::Handle type) : data_(std::move(data)), type_(std::move(type)) {}
  hdf5::Handle data_, type_;
  std::uint64_t stored_ = 0;
  std::vector<Row> pending_;
};

}  // namespace protocol
