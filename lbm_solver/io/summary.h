// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/wire/messages.h"

namespace lbm {

/// What remains of a run: written as `summary.json`, where a scene's plot script adds its results.
struct Summary {
  std::string scene, set, variant;
  std::map<std::string, std::string> versions;
  std::string ending;  ///< "complete", or who stopped and why
  long cells = 0;
  long steps = 0;    ///< fluid steps made
  int substeps = 1;  ///< solid steps a coupling interval
  double physical_seconds = 0.0, wall_seconds = 0.0, cpu_seconds = 0.0;
  double mlups = 0.0;  ///< million lattice updates a second of wall time, everything included
  std::map<std::string, double> time_share;  ///< part -> fraction of the wall time
  std::map<std::string, double> megabytes;   ///< part of the fluid's memory -> its size
  /// Most memory that the first rank, any and all of them had, with what the system counts in.
  std::map<std::string, double> peak_megabytes;
  double busiest_rank = 1.0;              ///< work of the busiest rank over the mean; 1 on one
  int block_moves = 0;                    ///< times that blocks of equal work were cut anew
  std::map<std::string, double> writing;  ///< kind of file -> seconds
  double waiting = 0.0;                   ///< seconds spent waiting for the solid
  bool overlapped = false;                ///< both programs compute at once
  double ma_max = 0.0;                    ///< max |u| / c_s
  double ma_paper = 0.0;                  ///< max |u| / C
  double re = 0.0, re_h = 0.0;
  double mass_drift = 0.0;                   ///< relative
  std::map<std::string, double> parameters;  ///< what a reader needs to interpret the results
  /// Grains that left and what became of bonds, where the solid tells it.
  std::optional<protocol::SolidReport> solid;
};

/// Grains that have left and bonds, in words; empty where there is nothing to tell.
std::string describe(const protocol::SolidReport& report);

/// Unit of a number of the summary or of its parameters; "1" for one without.
/// @throws std::out_of_range  the table in summary.cpp lacks it
std::string unit_of(const std::string& name);

/// Writes `folder`/summary.json, whole or not at all; "units" there names the unit of each number.
void write_summary(const std::string& folder, const Summary& summary);

}  // namespace lbm
