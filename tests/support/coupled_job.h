// SPDX-License-Identifier: GPL-2.0-or-later
/// Coupled jobs of the real programs, as the tests start them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/job.h"

namespace test {

inline const std::string kBin = BPLBM_BIN_DIR;
inline const std::string kLbm = kBin + "/lbm";
inline const std::string kLiggghts = kBin + "/liggghts";
inline const std::string kReplay = kBin + "/replay";
inline const std::string kCase = BPLBM_SOURCE_DIR "/cases/settling_disc";

/// A program of an MPMD job: command line and number of ranks.
struct Program {
  std::string command;
  int ranks = 1;
};

inline std::string mpirun(const Program& first, const Program& second) {
  return "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
         "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np " +
         std::to_string(first.ranks) + " " + first.command + " : -np " +
         std::to_string(second.ranks) + " " + second.command;
}

/// The settling disc's script with the files that it includes in their places, so that a test can
/// change any line.
inline std::string whole_script() {
  std::string script = read_file(kCase + "/in.liggghts");
  const std::string folder = "${scene_folder}";
  for (std::size_t at; (at = script.find("include ")) != std::string::npos;) {
    const std::size_t end = script.find('\n', at), path = script.find(folder, at) + folder.size();
    script.replace(at, end - at, read_file(kCase + script.substr(path, end - path)));
  }
  return script;
}

/// A job ended by itself before its limit, with an exit code, and said all of the words.
inline void expect_end(const JobResult& job, int exit_code, const std::vector<std::string>& words) {
  EXPECT_FALSE(job.timed_out) << "hangs: " << job.output;
  EXPECT_EQ(job.exit_code, exit_code) << job.output;
  for (const auto& word : words)
    EXPECT_NE(job.output.find(word), std::string::npos) << word << " not in:\n" << job.output;
}

/// A folder with the settling disc's scene at ten cells a diameter, short, to be changed at will.
class SettlingDisc {
 public:
  SettlingDisc() {
    set_scene(replaced(replaced(read_file(kCase + "/scene.toml"), "cells_per_diameter = 20",
                                "cells_per_diameter = 10"),
                       "end_time = 1.0", "end_time = 0.04"));
    set_script(whole_script());
  }
  const std::string& folder() const { return folder_.path(); }
  const std::string& scene() const { return scene_; }
  const std::string& script() const { return script_; }
  void set_scene(const std::string& text) { folder_.write("scene.toml", scene_ = text); }
  void set_script(const std::string& text) { folder_.write("in.liggghts", script_ = text); }
  void change_scene(const std::string& from, const std::string& to) {
    set_scene(replaced(scene_, from, to));
  }
  void change_script(const std::string& from, const std::string& to) {
    set_script(replaced(script_, from, to));
  }

  /// Runs `mpirun lbm : liggghts` in the folder. Both options strings may be empty.
  JobResult run(const std::string& lbm_options = "", int solid_ranks = 1, double limit = 60.0,
                const std::string& liggghts_options = "-screen none") const {
    return test::run(
        mpirun({kLbm + " " + lbm_options}, {kLiggghts + " " + liggghts_options, solid_ranks}),
        folder(), limit);
  }
  std::string output(const std::string& name) const { return read_file(folder() + "/out/" + name); }

 private:
  TemporaryFolder folder_;
  std::string scene_, script_;
};

}  // namespace test
