// SPDX-License-Identifier: GPL-2.0-or-later
/// Scripts of bonded discs for the real LIGGGHTS, and what they leave behind.
#pragma once

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/support/coupled_job.h"

namespace test {

/// Stiffness [N/m] and strength [N] of the bonds, damping ratio.
struct Law {
  double stiffness = 1e5, shear_stiffness = 5e4, tensile = 20.0, shear = 1e9, damping = 0.0;
};

inline std::string property(const std::string& name, double value) {
  std::ostringstream text;
  text << "fix " << name << " all property/global " << name << " peratomtypepair 1 " << value
       << '\n';
  return text.str();
}

/// The lines before any particle. @param box  x_lo x_hi y_lo y_hi
inline std::string head(const std::string& boundary = "f f p", const std::string& box = "0 1 0 1") {
  return "dimension 2\nunits si\natom_style granular\natom_modify map array\nboundary " + boundary +
         "\nnewton off\ncommunicate single vel yes\nregion box block " + box +
         " -0.5 0.5 units box\ncreate_box 1 box\nneighbor 0.02 bin\nneigh_modify delay 0\n";
}

/// Properties and pair style. @param name  bond/contact or bond/parallel
inline std::string model(const Law& law, const std::string& name = "bond/contact") {
  return property("contactNormalStiffness", 1e5) + property("contactShearStiffness", 5e4) +
         property("coefficientFriction", 0.5) + property("contactDampingRatio", law.damping) +
         property("bondNormalStiffness", law.stiffness) +
         property("bondShearStiffness", law.shear_stiffness) +
         property("bondTensileStrength", law.tensile) + property("bondShearStrength", law.shear) +
         "pair_style gran model " + name + " ledger on\npair_coeff * *\n";
}
inline const std::string kBonds =
    "fix make all bond/create gap 1e-6\nfix breaks all bond/breaks every 100 file breaks.csv\n";

inline std::string disc(double x, double y) {
  std::ostringstream text;
  text.precision(17);
  text << "create_atoms 1 single " << x << ' ' << y << " 0.0 units box\n";
  return text.str();
}

/// LIGGGHTS scripts and their output in a folder of its own.
class Script {
 public:
  JobResult run(const std::string& text, int ranks = 1, const std::string& name = "in.script") {
    folder_.write(name, text);
    return test::run(
        "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
        "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np " +
            std::to_string(ranks) + " " + kLiggghts + " -in " + name,
        folder_.path(), 100.0);
  }
  std::string file(const std::string& name) const { return read_file(folder_.path() + "/" + name); }

 private:
  TemporaryFolder folder_;
};

/// Rows of a CSV file without its head, as text fields.
inline std::vector<std::vector<std::string>> rows(const std::string& csv) {
  std::vector<std::vector<std::string>> result;
  std::istringstream lines(csv);
  std::string line, field;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    result.emplace_back();
    while (std::getline(fields, field, ',')) result.back().push_back(field);
  }
  return result;
}

inline void expect_ok(const JobResult& job) {
  ASSERT_EQ(job.exit_code, 0) << job.output;
}

/// Two discs at 0.1 m; the second is moved with a constant velocity.
inline std::string pulled_pair(const Law& law, const std::string& velocity) {
  return head() + disc(0.45, 0.5) + disc(0.55, 0.5) + "set type 1 diameter 0.1 density 1000\n" +
         model(law) + kBonds +
         "timestep 1e-5\ngroup a id 1\ngroup b id 2\nfix m1 a move linear 0 0 0\n"
         "fix m2 b move linear " +
         velocity + "\nrun 2500\n";
}

}  // namespace test
