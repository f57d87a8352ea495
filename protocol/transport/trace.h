// SPDX-License-Identifier: MIT
/// A recorded exchange: everything one rank sent and received, at full precision.
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "protocol/transport/trace_tables.h"
#include "protocol/wire/channel.h"

namespace protocol {

/// Writes the frames of one rank. The file is readable at any moment, also after a kill.
class TraceWriter {
 public:
  /// @throws std::runtime_error where the file cannot be created
  TraceWriter(const std::string& path, const std::string& recorder, int local_rank,
              int remote_size);
  ~TraceWriter();
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  void record(Direction direction, int remote, const Bytes& frame);
  void flush();

 private:
  hdf5::Handle file_;
  Table<FrameRow> frames_;
  Table<State> states_;
  Table<Shape> shapes_;
  Table<Load> loads_;
  Table<std::byte> bytes_;
  std::chrono::steady_clock::time_point start_, flushed_;
};

/// A whole trace in memory.
class Trace {
 public:
  /// @throws std::runtime_error where the file is missing or no trace
  explicit Trace(const std::string& path);

  const std::string& recorder() const { return recorder_; }  ///< "fluid" or "solid"
  int local_rank() const { return local_rank_; }
  int remote_size() const { return remote_size_; }
  const std::vector<FrameRow>& frames() const { return frames_; }

  /// The frame as it went over the wire, to the bit.
  Bytes frame(const FrameRow& row) const;
  std::span<const State> states(const FrameRow& row) const;
  std::span<const Shape> shapes(const FrameRow& row) const;
  std::span<const Load> loads(const FrameRow& row) const;

  /// The handshake of a side. @throws std::runtime_error where the recording ended before it
  Hello hello(Role role) const;

 private:
  StepHeader header(const FrameRow& row) const { return {row.interval, row.time, row.flags}; }
  std::string recorder_;
  int local_rank_ = 0, remote_size_ = 0;
  std::vector<FrameRow> frames_;
  std::vector<State> states_;
  std::vector<Shape> shapes_;
  std::vector<Load> loads_;
  std::vector<std::byte> bytes_;
};

/// Passes everything on to `inner` and writes it down.
std::unique_ptr<Channel> make_recording_channel(std::unique_ptr<Channel> inner,
                                                std::unique_ptr<TraceWriter> writer);

/// Stands in for the partner of the rank that recorded `trace`: `receive` returns what was
/// recorded. `send` compares with what was recorded and throws ProtocolError at the first
/// difference.
std::unique_ptr<Channel> make_replay_channel(std::shared_ptr<const Trace> trace);

}  // namespace protocol
