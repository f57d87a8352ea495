// SPDX-License-Identifier: GPL-2.0-or-later
/// What lbm has in place of HDF5 files where it is built without HDF5: whatever asks for one is
/// refused before, by its name (hdf5_files.h).
#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/average_writer.h"
#include "lbm_solver/io/checkpoint.h"
#include "lbm_solver/io/field_writer.h"
#include "lbm_solver/io/hdf5_files.h"

namespace lbm {
namespace {

[[noreturn]] void refuse(const std::string& file) {
  throw InputError(file, kNeedsHdf5, kWithoutHdf5);
}

}  // namespace

bool has_hdf5() {
  return false;
}

void write_checkpoint(const std::string& path, const Record&, std::int64_t, const std::string&,
                      const Decomposition*) {
  refuse(path);
}
Record read_checkpoint(const std::string& path) {
  refuse(path);
}
Record read_record(const std::string& path) {
  refuse(path);
}

ShownObstacles::ShownObstacles(const Scene&) {}

FieldWriter::FieldWriter(const std::string& folder, const Units&, int, double, ShownObstacles) {
  refuse(folder + "/fields.h5");
}
void FieldWriter::write(const FieldFrame&, const Decomposition&) {}

void write_averages(const std::string& folder, const FieldAverages&, const Units&,
                    const Decomposition&) {
  refuse(folder + "/averages.h5");
}

}  // namespace lbm
