// SPDX-License-Identifier: GPL-2.0-or-later
/// Any bytes as a checkpoint: an InputError. As the content of one whose checksum is right: a
/// record of small parts that is written and read again, or a std::runtime_error.
#include <hdf5.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <string>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/checkpoint.h"

namespace {

using lbm::Record;

const std::string kPath = "/dev/shm/bplbm_fuzz_checkpoint_" + std::to_string(getpid()) + ".h5";

/// Names, types, sizes and values of a record from the bytes, three deep at most.
Record record_of(const std::uint8_t*& at, const std::uint8_t* end, int depth) {
  Record record;
  while (end - at >= 3) {
    const std::uint8_t kind = *at++ % 7, size = *at++ % 16, value = *at++;
    const std::string name = "n" + std::to_string(value % 32);
    if (kind == 0) return record;
    if (kind == 1) record.set(name, std::int64_t{value} - 128);
    if (kind == 2) record.set(name, 0.1 * value);
    if (kind == 3) record.set(name, std::string(size, static_cast<char>('a' + value % 26)));
    if (kind == 4) record.set(name, std::vector<double>(size, 1.0 / (1.0 + value)));
    if (kind == 5) record.set(name, std::vector<std::int64_t>(size, value));
    if (kind == 6 && depth < 3) record.set("p" + name, record_of(at, end, depth + 1));
  }
  return record;
}

void read_any_bytes(const std::uint8_t* data, std::size_t size) {
  std::ofstream(kPath, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    lbm::read_checkpoint(kPath);
    __builtin_trap();  // a checksum that was guessed
  } catch (const lbm::InputError&) {
  }
}

/// Written, and read again whole, and with a byte changed.
void read_written(const std::uint8_t* data, std::size_t size) {
  const std::uint8_t* at = data;
  const Record record = record_of(at, data + size, 0);
  lbm::write_checkpoint(kPath, record, static_cast<std::int64_t>(size));
  if (!(lbm::read_checkpoint(kPath) == record)) __builtin_trap();
  std::fstream file(kPath, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(0, std::ios::end);
  const auto place =
      (size < 4 ? 0 : data[0] * 256U + data[1]) % static_cast<unsigned>(file.tellp());
  file.seekg(place);
  const int byte = file.get();
  file.seekp(place);
  file.put(static_cast<char>(byte ^ 1 << (size % 8)));
  file.close();
  try {
    lbm::read_checkpoint(kPath);
    __builtin_trap();  // a change that was not noticed
  } catch (const lbm::InputError&) {
  }
}

}  // namespace

/// HDF5 keeps the memory that it has freed: inputs a second are more than double.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return H5set_free_list_limits(-1, -1, -1, -1, -1, -1) < 0 ? 1 : 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0 && data[size - 1] % 4 == 0)
    read_written(data, size - 1);
  else
    read_any_bytes(data, size);
  unlink(kPath.c_str());
  return 0;
}
