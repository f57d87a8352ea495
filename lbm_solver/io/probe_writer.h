// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdio>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>

#include "protocol/wire/session.h"

namespace lbm {

/// A table of numbers that grows line by line and is complete on disk after each. A number that is
/// none (the pressure where there is no fluid) is an empty field.
class CsvWriter {
 public:
  /// @param path        overwritten, but for the lines kept
  /// @param columns     first line, each with its unit: "time [s],x [m]"; the first is the time
  /// @param keep_until  a run that goes on keeps the lines before this time
  /// @throws InputError  one of the lines that are there is no row of the table
  CsvWriter(const std::string& path, const std::string& columns, double keep_until = 0.0);
  void row(std::span<const double> values);
  void row(std::initializer_list<double> values) {
    row(std::span<const double>(values.begin(), values.size()));
  }
  /// @throws ProgramError  what was written is lost: the disk is full, or somebody has deleted the
  /// file meanwhile, which the system would go on writing without a word
  void flush();

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
};

/// Appends one line a particle to `probes.csv`: its motion at the beginning of an interval and the
/// load it received over it; at the last state, with which no interval begins, the load over the
/// one before. SI units.
class ProbeWriter {
 public:
  ProbeWriter(const std::string& folder, int dimension, double keep_until);
  /// @param loads  same order as the particles
  void write(double time, std::span<const protocol::Particle> particles,
             std::span<const protocol::Load> loads);

 private:
  int dimension_;
  CsvWriter table_;
};

}  // namespace lbm
