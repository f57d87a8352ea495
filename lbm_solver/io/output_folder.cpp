// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/output_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "lbm_solver/base/errors.h"

namespace lbm {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".bplbm";
/// Of a run that has begun: these hold its results, or what it can go on from.
constexpr std::array kResults{
    "summary.json", "probes.csv",    "points.csv",           "obstacles.csv", "fields.h5",
    "fields.xdmf",  "checkpoint.h5", "checkpoint.before.h5", "fault.h5",      "fields-cut-off.h5"};
constexpr std::array kOthers{"lbm.log",  "liggghts.log", "lammps.log",  "breaks.csv",
                             "plot.log", "view.py",      "averages.h5", "averages.xdmf"};

bool is_marked(const fs::path& folder) {
  return fs::is_regular_file(folder / kMark);
}

/// But for a lock, which a kill may have left before there was a mark.
bool holds_nothing(const fs::path& folder) {
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const auto& entry) { return entry.path().filename() == ".bplbm.lock"; });
}

bool holds_run(const fs::path& folder) {
  return std::any_of(kResults.begin(), kResults.end(),
                     [&](const char* name) { return fs::exists(folder / name); });
}

void mark(const fs::path& folder, const std::string& scene) {
  std::ofstream out(folder / kMark);
  out << "# BPLBM made this folder; a later run may replace its own files in it.\n"
      << "program lbm " << BPLBM_VERSION << "\nscene " << scene << "\n";
  if (!out.flush())
    throw InputError((folder / kMark).string(), "cannot be written",
                     "give a folder that is writable as --out; is the disk full?");
}

/// checkpoint.K.solid, fault.K.solid, meshK.stl, and what a kill left of a file half written.
bool is_part(const std::string& name) {
  const bool state = name.starts_with("checkpoint.") || name.starts_with("fault.");
  return (state && name.ends_with(".solid")) ||
         (name.ends_with(".part") && (state || name.starts_with("summary.json"))) ||
         name.ends_with(".csv.part") || (name.starts_with("sensor-") && name.ends_with(".csv")) ||
         (name.starts_with("mesh") && name.ends_with(".stl")) ||
         (name.starts_with("fields-cut-off") && name.ends_with(".h5"));
}

/// A name in the mark stays inside the folder, whoever wrote it.
bool is_plain(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

/// Removes the files of a run from a marked folder, and from those of its comparison runs.
void remove_run(const fs::path& folder) {
  std::error_code none;
  std::ifstream marks(folder / kMark);
  for (std::string line; std::getline(marks, line);)
    if (line.starts_with("file ") && is_plain(line.substr(5)) &&
        fs::symlink_status(folder / line.substr(5)).type() != fs::file_type::directory)
      fs::remove(folder / line.substr(5), none);
  for (const char* name : kResults) fs::remove(folder / name, none);
  for (const char* name : kOthers) fs::remove(folder / name, none);
  for (const auto& entry : fs::directory_iterator(folder))
    if (is_part(entry.path().filename())) fs::remove(entry.path(), none);
  if (fs::symlink_status(folder / "study").type() != fs::file_type::directory) return;
  for (const auto& entry : fs::directory_iterator(folder / "study")) {
    if (!entry.is_directory() || entry.is_symlink() || !is_marked(entry.path())) continue;
    remove_run(entry.path());
    fs::remove(entry.path() / kMark, none);
    if (holds_nothing(entry.path())) fs::remove(entry.path(), none);
  }
}

fs::path free_name(const fs::path& folder) {
  for (int k = 1;; ++k) {
    fs::path name = folder;
    name += fmt::format(".{}", k);
    if (!fs::exists(fs::symlink_status(name))) return name;
  }
}

}  // namespace

OutputFolder::OutputFolder(const std::string& given, const std::string& scene,
                           EarlierRun earlier) try {
  fs::path path = given;
  if (fs::exists(path) && !fs::is_directory(path))
    throw InputError(given, "is no folder", "choose another --out");
  if (earlier == EarlierRun::GoOn) {
    lock_.emplace(given);
    if (!is_marked(path)) mark(path, scene);
    return;
  }
  fs::create_directories(path);
  path = fs::canonical(path);  // of a link, what it points at is set aside
  const bool ours = is_marked(path);
  if (!ours && !holds_nothing(path))
    throw InputError(
        given, fmt::format("is not empty, and no folder of an earlier run (it has no {})", kMark),
        "give a new or an empty folder as --out");
  lock_.emplace(path.string());
  if (ours && earlier == EarlierRun::Replace) remove_run(path);
  if (ours && holds_run(path)) begin_anew(path.string());
  if (!ours || earlier == EarlierRun::Replace || !set_aside_.empty()) mark(path, scene);
} catch (const fs::filesystem_error& error) {
  throw InputError(given, error.code().message(), "choose another --out");
}

/// Gives the folder of the earlier run another name, and makes a new one in its place.
void OutputFolder::begin_anew(const std::string& path) {
  const fs::path aside = free_name(path);
  std::error_code failed;
  fs::rename(path, aside, failed);
  if (failed)
    throw InputError(path,
                     fmt::format("holds an earlier run and cannot be renamed to {}: {}",
                                 aside.string(), failed.message()),
                     "give another --out, or --force to replace that run");
  lock_->moved_to(aside.string());
  set_aside_ = aside.string();
  fs::create_directory(path);
  lock_.emplace(path);
}

}  // namespace lbm
