// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/probe_writer.h"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "protocol/wire/numbers.h"

namespace lbm {
namespace {

/// Time of a row that has a number or nothing for every column.
std::optional<double> time_of(const std::string& line, const std::string& columns) {
  std::optional<double> time;
  std::size_t fields = 0;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1, ++fields) {
    end = line.find(',', begin);
    const std::string_view field = std::string_view(line).substr(begin, end - begin);
    const auto number = protocol::to_number<double>(field);
    if (!number && (fields == 0 || !field.empty()) && field != "inf" && field != "-inf")
      return std::nullopt;
    if (fields == 0) time = number;
  }
  const auto due = static_cast<std::size_t>(std::ranges::count(columns, ',')) + 1;
  return fields == due ? time : std::nullopt;
}

}  // namespace

CsvWriter::CsvWriter(const std::string& path, const std::string& columns, double keep_until)
    : path_(path) {
  std::vector<std::string> kept;
  if (keep_until > 0.0) {
    std::ifstream before(path);
    std::string line;
    std::getline(before, line);  // the columns
    for (int number = 2; std::getline(before, line) && !before.eof(); ++number) {
      // a line that a kill has cut off is the last, and has no end
      const std::optional<double> time = time_of(line, columns);
      if (!time)
        throw InputError(fmt::format("{}: line {}", path, number),
                         "is damaged: it is no row of this table",
                         "mend or delete the line, or move the table away: it then begins with "
                         "the restart");
      if (*time < keep_until) kept.push_back(line);
    }
  }
  // under another name, or a kill at this moment would lose the lines of the run before
  const std::string part = path + ".part";
  file_.reset(std::fopen(part.c_str(), "w"));
  if (!file_) throw InputError(path, "cannot be written", "choose another --out");
  fmt::print(file_.get(), "{}\n", columns);
  for (const std::string& line : kept) fmt::print(file_.get(), "{}\n", line);
  if (std::fflush(file_.get()) != 0 || std::rename(part.c_str(), path.c_str()) != 0)
    throw protocol::ProgramError(path + " cannot be written; is the disk full?");
}

void CsvWriter::row(std::span<const double> values) {
  const char* separator = "";
  for (const double v : values) {
    fmt::print(file_.get(), "{}", separator);
    if (!std::isnan(v)) fmt::print(file_.get(), "{:.12g}", v);
    separator = ",";
  }
  fmt::print(file_.get(), "\n");
}

void CsvWriter::flush() {
  struct stat status {};
  if (std::fflush(file_.get()) != 0 || std::ferror(file_.get()))
    throw protocol::ProgramError(path_ + " cannot be written; is the disk full?");
  if (fstat(fileno(file_.get()), &status) == 0 && status.st_nlink > 0) return;
  throw protocol::ProgramError(path_ +
                               " was deleted while the run was writing it; start the run again, "
                               "and leave its folder alone until it has ended");
}

ProbeWriter::ProbeWriter(const std::string& folder, int dimension, double keep_until)
    : dimension_(dimension),
      table_(folder + "/probes.csv",
             dimension == 2
                 ? "time [s],id [1],x [m],y [m],vx [m/s],vy [m/s],omega [rad/s],fx [N],fy [N],"
                   "torque [N m]"
                 : "time [s],id [1],x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],"
                   "wy [rad/s],wz [rad/s],fx [N],fy [N],fz [N],tx [N m],ty [N m],tz [N m]",
             keep_until) {}

void ProbeWriter::write(double time, std::span<const protocol::Particle> particles,
                        std::span<const protocol::Load> loads) {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const protocol::State& s = particles[i].state;
    const auto& [x, v, w, f, t] = std::tie(s.x, s.v, s.omega, loads[i].force, loads[i].torque);
    const auto id = static_cast<double>(s.id);
    if (dimension_ == 2)
      table_.row({time, id, x[0], x[1], v[0], v[1], w[2], f[0], f[1], t[2]});
    else
      table_.row({time, id, x[0], x[1], x[2], v[0], v[1], v[2], w[0], w[1], w[2], f[0], f[1], f[2],
                  t[0], t[1], t[2]});
  }
  table_.flush();
}

}  // namespace lbm
