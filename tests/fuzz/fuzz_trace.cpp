// SPDX-License-Identifier: MIT
/// Tables of a trace file with any frames in them: a std::runtime_error, or a timeline. (What HDF5
/// makes of a damaged file is HDF5's affair.)
#include <hdf5.h>
#include <unistd.h>

#include <cstring>
#include <string>

#include "protocol/transport/trace_compare.h"
#include "protocol/wire/errors.h"

namespace {

using namespace protocol;

constexpr std::uint64_t kChunk = 16;  // a recording's would make each file a megabyte

template <class Row>
void fill(hid_t file, const char* name, std::size_t rows) {
  auto table = Table<Row>::create(file, name, kChunk);
  const std::vector<Row> all(rows);
  if (rows) table.append(all);
  table.flush();
}

/// Eleven bytes of input are a frame: every field small, so that some of them fit together.
FrameRow row_of(const std::uint8_t* b) {
  FrameRow row;
  row.interval = static_cast<std::int8_t>(b[0]);
  row.direction = static_cast<Direction>(b[1] % 3);
  row.kind = static_cast<Kind>(b[2] % 9);
  row.remote = static_cast<std::int8_t>(b[3]) / 32;
  row.flags = b[4];
  row.first = b[5] < 250 ? b[5] % 8 : ~0ULL - b[5];
  row.count = b[6] < 250 ? b[6] % 8 : ~0ULL - b[6];
  row.shape_first = b[7] % 8;
  row.shape_count = b[8] < 250 ? b[8] % 8 : ~0ULL;
  row.time = b[9];
  row.wall_clock = b[10];
  return row;
}

}  // namespace

/// HDF5 keeps the memory that it has freed: inputs a second are more than double.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return H5set_free_list_limits(-1, -1, -1, -1, -1, -1) < 0 ? 1 : 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string path = "/dev/shm/bplbm_fuzz_" + std::to_string(getpid()) + ".h5";
  {
    const hdf5::Handle file = hdf5::open_file(path, hdf5::Open::CreateForReaders);
    auto frames = Table<FrameRow>::create(file, "frames", kChunk);
    for (std::size_t at = 0; at + 11 <= size && at < 110; at += 11) {
      const FrameRow row = row_of(data + at);
      frames.append({&row, 1});
    }
    frames.flush();
    fill<State>(file, "states", 6);
    fill<Shape>(file, "shapes", 6);
    fill<Load>(file, "loads", 6);
    auto bytes = Table<std::byte>::create(file, "bytes", kChunk);
    bytes.append(std::as_bytes(std::span(data, std::min<std::size_t>(size, 200))));
    bytes.flush();
    hdf5::set_attribute(file, "trace_version", std::int64_t{2});
    hdf5::set_attribute(file, "recorder", std::string("fluid"));
    hdf5::set_attribute(file, "local_rank", std::int64_t{0});
    hdf5::set_attribute(file, "remote_size", std::int64_t{2});
  }
  try {
    const Trace trace(path);
    const auto record = timeline(trace);
    TraceComparison compare(record);
    for (const auto& r : record) compare.states(r.head.interval, r.states, r.states);
    for (const FrameRow& row : trace.frames()) trace.frame(row);
    trace.hello(Role::Fluid);
  } catch (const std::runtime_error&) {
  }
  unlink(path.c_str());
  return 0;
}
