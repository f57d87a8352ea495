// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "lbm_solver/base/record.h"
#include "lbm_solver/field/decomposition.h"

namespace lbm {

/// The fluid's part of a checkpoint: an HDF5 file, in which a part of the record is a group, a list
/// or a text a data set, values of cells one of four dimensions, a number an attribute, each under
/// its name; then a line of text,
///   BPLBM checkpoint 1 interval K bytes N crc32 C
/// with K the interval, N the length of the HDF5 file, and C the checksum of everything before it.

/// Writes a record to `path`, whole or not at all: a kill meanwhile leaves the checkpoint before.
/// @param before  name that the one in `path` gets; empty: it is replaced
/// @param ranks   that share the cells: the first writes, others send it theirs, from records with
///                the same values of cells. Collective. Null: there is one rank
/// @throws std::runtime_error, InputError  the disk is full, say
void write_checkpoint(const std::string& path, const Record& record, std::int64_t interval,
                      const std::string& before = {}, const Decomposition* ranks = nullptr);

/// Values of cells are read from the file when they are asked for.
/// @throws InputError  the file is missing, no checkpoint, of another version, or damaged
Record read_checkpoint(const std::string& path);

/// The HDF5 file in a checkpoint, whatever stands behind it. @throws std::runtime_error
Record read_record(const std::string& path);

}  // namespace lbm
