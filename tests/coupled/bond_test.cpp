// SPDX-License-Identifier: GPL-2.0-or-later
/// pair_style gran model bond/contact in the real LIGGGHTS: breaks to the step, ranks, restart,
/// periodic sides, strength of a lattice, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;

struct Law {
  double stiffness = 1e5, shear_stiffness = 5e4, tensile = 20.0, shear = 1e9, damping = 0.0;
};

std::string property(const std::string& name, double value) {
  std::ostringstream text;
  text << "fix " << name << " all property/global " << name << " peratomtypepair 1 " << value
       << '\n';
  return text.str();
}

/// The lines before any particle. @param box  x_lo x_hi y_lo y_hi
std::string head(const std::string& boundary = "f f p", const std::string& box = "0 1 0 1") {
  return "dimension 2\nunits si\natom_style granular\natom_modify map array\nboundary " + boundary +
         "\nnewton off\ncommunicate single vel yes\nregion box block " + box +
         " -0.5 0.5 units box\ncreate_box 1 box\nneighbor 0.02 bin\nneigh_modify delay 0\n";
}

std::string model(const Law& law) {
  return property("contactNormalStiffness", 1e5) + property("contactShearStiffness", 5e4) +
         property("coefficientFriction", 0.5) + property("contactDampingRatio", law.damping) +
         property("bondNormalStiffness", law.stiffness) +
         property("bondShearStiffness", law.shear_stiffness) +
         property("bondTensileStrength", law.tensile) + property("bondShearStrength", law.shear) +
         "pair_style gran model bond/contact ledger on\npair_coeff * *\n";
}
const std::string kBonds =
    "fix make all bond/create gap 1e-6\nfix breaks all bond/breaks every 100 file breaks.csv\n";

std::string disc(double x, double y) {
  std::ostringstream text;
  text.precision(17);
  text << "create_atoms 1 single " << x << ' ' << y << " 0.0 units box\n";
  return text.str();
}

class Script {
 public:
  JobResult run(const std::string& text, int ranks = 1, const std::string& name = "in.script") {
    folder_.write(name, text);
    return test::run(
        "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
        "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np " +
            std::to_string(ranks) + " " + test::kLiggghts + " -in " + name,
        folder_.path(), 100.0);
  }
  std::string file(const std::string& name) const {
    return test::read_file(folder_.path() + "/" + name);
  }

 private:
  test::TemporaryFolder folder_;
};

/// Rows of a CSV file without its head, as text fields.
std::vector<std::vector<std::string>> rows(const std::string& csv) {
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

void expect_ok(const JobResult& job) {
  ASSERT_EQ(job.exit_code, 0) << job.output;
}

/// Two discs at 0.1 m; the second is moved with a constant velocity.
std::string pulled_pair(const Law& law, const std::string& velocity) {
  return head() + disc(0.45, 0.5) + disc(0.55, 0.5) + "set type 1 diameter 0.1 density 1000\n" +
         model(law) + kBonds +
         "timestep 1e-5\ngroup a id 1\ngroup b id 2\nfix m1 a move linear 0 0 0\n"
         "fix m2 b move linear " +
         velocity + "\nrun 2500\n";
}

TEST(Bond, BreaksByTensionAtItsStep) {
  Script script;
  expect_ok(script.run(pulled_pair({}, "0.01 0 0")));
  const auto breaks = rows(script.file("breaks.csv"));
  ASSERT_EQ(breaks.size(), 1U);
  EXPECT_NEAR(std::stod(breaks[0][0]), 2000.0, 1.0);  // F_bn/(k v Δt)
  EXPECT_EQ(breaks[0][2] + " " + breaks[0][3] + " " + breaks[0][4], "1 2 tension");
  EXPECT_NEAR(std::stod(breaks[0][5]), 20.0, 0.02);
  EXPECT_NEAR(std::stod(breaks[0][6]), 0.5001, 1e-6);  // the middle of the gap
  EXPECT_NEAR(std::stod(breaks[0][9]), -1.0, 1e-12);   // from the second to the first
}

TEST(Bond, BreaksByShearAtItsStep) {
  Script script;
  // F_bs/(k_t v Δt) = 30/(5e4 · 0.1 · 1e-5) = 600 steps; neither disc turns
  expect_ok(script.run(pulled_pair({1e5, 5e4, 1e3, 30.0}, "0 0.1 0")));
  const auto breaks = rows(script.file("breaks.csv"));
  ASSERT_EQ(breaks.size(), 1U);
  EXPECT_NEAR(std::stod(breaks[0][0]), 600.0, 1.0);
  EXPECT_EQ(breaks[0][4], "shear");
}

/// 25 × 20 discs, a little off a square lattice so that no two bonds are alike, that fly apart.
std::string cluster(const std::string& then) {
  std::string discs;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 25; ++i)
      discs += disc(0.13 + 0.03 * i + 5e-5 * std::sin(7.0 * i + 3.1 * j),
                    0.2 + 0.03 * j + 5e-5 * std::cos(5.0 * j + 2.3 * i));
  return head() + discs +
         "set group all diameter 0.03 density 1000\n"
         "velocity all ramp vx -1 1.5 x 0 1 units box\nvelocity all ramp vy -1 2 x 0 1 units "
         "box\n" +
         model({1e5, 5e4, 60.0, 30.0, 0.05}) + test::replaced(kBonds, "gap 1e-6", "gap 3e-4") +
         "fix move all nve/sphere\nfix flat all enforce2d\ntimestep 1e-5\n"
         "thermo_style custom step atoms ke f_breaks[1] f_breaks[2] f_breaks[3] f_breaks[4]\n"
         "thermo 500\nthermo_modify format float %.14g\n" +
         then;
}

const std::string kFinalState =
    "dump last all custom 1 state.txt id x y vx vy omegaz\ndump_modify last sort id format "
    "\"%d %.17g %.17g %.17g %.17g %.17g\"\nrun 0\n";

/// Values of a dump's only frame.
std::vector<double> values(const std::string& dump) {
  std::istringstream text(dump.substr(dump.find("ITEM: ATOMS")));
  std::string line;
  std::getline(text, line);
  std::vector<double> all;
  for (double v = 0.0; text >> v;) all.push_back(v);
  return all;
}

TEST(Bond, AClusterBreaksAlikeOnAnyNumberOfRanks) {
  std::vector<std::vector<std::vector<std::string>>> events;
  std::vector<std::vector<double>> states;
  for (const int ranks : {1, 2, 4}) {
    Script script;
    expect_ok(script.run(cluster("run 11000\n" + kFinalState), ranks));
    events.push_back(rows(script.file("breaks.csv")));
    states.push_back(values(script.file("state.txt")));
  }
  ASSERT_GT(events[0].size(), 100U);
  ASSERT_EQ(states[0].size(), 500U * 6U);
  for (const int other : {1, 2}) {
    ASSERT_EQ(events[other].size(), events[0].size());
    for (std::size_t k = 0; k < events[0].size(); ++k) {
      EXPECT_EQ(events[other][k][0], events[0][k][0]);  // step
      for (const int column : {2, 3, 4}) EXPECT_EQ(events[other][k][column], events[0][k][column]);
    }
    double largest = 0.0;
    for (std::size_t k = 0; k < states[0].size(); ++k)
      largest = std::max(largest, std::abs(states[other][k] - states[0][k]) /
                                      std::max(1.0, std::abs(states[0][k])));
    EXPECT_LT(largest, 1e-10);
  }
}

TEST(Bond, RestartInTheMiddleOfAFractureIsBitIdentical) {
  Script script;
  expect_ok(script.run(cluster("run 700\nwrite_restart half.rst\nrun 700\n" + kFinalState)));
  const std::string state = script.file("state.txt"), breaks = script.file("breaks.csv");
  // the same lines, but the particles come from the file; bond/create must not bond them again
  std::string again = cluster("run 700\n" + kFinalState);
  const std::size_t from = again.find("region box"), to = again.find("fix contactNormalStiffness");
  again = again.substr(0, from) +
          "read_restart half.rst\nneighbor 0.02 bin\nneigh_modify delay 0\n" + again.substr(to);
  expect_ok(script.run(again, 1, "in.again"));
  EXPECT_EQ(script.file("state.txt"), state);
  EXPECT_EQ(script.file("breaks.csv"), breaks);
}

TEST(Bond, ADimerCrossesAPeriodicSideAlikeOnTwoRanks) {
  std::vector<std::string> states;
  for (const int ranks : {1, 2}) {
    Script script;
    expect_ok(
        script.run(head("p f p") + disc(0.45, 0.5) + disc(0.55, 0.5) +
                       "set type 1 diameter 0.1 density 1000\nvelocity all set 5.0 0.1 0 units "
                       "box\nset atom 2 vx 5.2\n" +
                       model({1e5, 5e4, 1e3, 1e9}) + kBonds +
                       "fix move all nve/sphere\nfix flat all enforce2d\ntimestep 1e-5\n"
                       "run 60000\n" +
                       kFinalState,
                   ranks));
    EXPECT_TRUE(rows(script.file("breaks.csv")).empty());
    states.push_back(script.file("state.txt").substr(script.file("state.txt").find("ITEM: ATOMS")));
  }
  EXPECT_EQ(states[0], states[1]);
}

TEST(Bond, ATriangularLatticeHasItsTensileStrength) {
  // Pulled across its rows, periodic along them, no shear stiffness: σ_t = √3 F_bn/l.
  const double l = 0.05, width = 0.5, strength = 20.0;
  std::string text = head("p f p", "0 0.5 0 1");
  const double rise = l * std::sqrt(3.0) / 2.0;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 10; ++i) text += disc((i + 0.25 + 0.5 * (j % 2)) * l, 0.3 + j * rise);
  std::ostringstream pull;
  pull << "group low id <= 10\ngroup high id >= 81\ngroup inner subtract all low high\n"
       << "fix move inner nve/sphere\nfix m1 low move linear 0 -0.00125 0\nfix m2 high move linear "
          "0 "
          "0.00125 0\nfix flat all enforce2d\ntimestep 1e-5\ncompute f high reduce sum fy\n"
       << "thermo_style custom step c_f\nfix p all ave/time 1 1 1 c_f file force.txt\nrun 88000\n";
  Script script;
  expect_ok(script.run(text + "set type 1 diameter 0.05 density 1000\n" +
                       model({1e5, 0.0, strength, 1e9, 0.5}) + kBonds + pull.str()));
  std::istringstream force(script.file("force.txt"));
  std::string line;
  double most = 0.0;
  while (std::getline(force, line)) {
    double step = 0.0, value = 0.0;
    if (std::istringstream(line) >> step >> value) most = std::max(most, std::abs(value));
  }
  EXPECT_NEAR(most / width / (std::sqrt(3.0) * strength / l), 1.0, 0.01);
  EXPECT_FALSE(rows(script.file("breaks.csv")).empty());
}

TEST(Bond, AChainDispersesAsItShould) {
  // ω = 2√(k/m) |sin(ql/2)|: 20 discs on a ring, wave of 10 discs' length: sin(18°)
  const int n = 20;
  std::string text = head("p f p", "0 2 0 1"), start;
  for (int i = 0; i < n; ++i) {
    text += disc(0.05 + 0.1 * i, 0.5);
    std::ostringstream v;
    v << "set atom " << i + 1 << " vx " << 1e-3 * std::sin(2.0 * std::numbers::pi * i / 10.0)
      << '\n';
    start += v.str();
  }
  Script script;
  expect_ok(
      script.run(text + "set type 1 diameter 0.1 density 1000\n" + start +
                 model({1e5, 5e4, 1e3, 1e9}) + kBonds +
                 "fix move all nve/sphere\nfix flat all enforce2d\ntimestep 1e-5\n"
                 "variable v equal vx[3]\nfix p all ave/time 1 1 1 v_v file v.txt\nrun 40000\n"));
  std::istringstream velocity(script.file("v.txt"));
  std::string line;
  std::vector<double> crossings;
  double before = 0.0;
  while (std::getline(velocity, line)) {
    double step = 0.0, v = 0.0;
    if (!(std::istringstream(line) >> step >> v)) continue;
    if (before < 0.0 && v >= 0.0) crossings.push_back((step - v / (v - before)) * 1e-5);
    before = v;
  }
  ASSERT_GT(crossings.size(), 2U);
  const double period = (crossings.back() - crossings.front()) / (crossings.size() - 1.0);
  const double mass = 1000.0 * std::numbers::pi * 0.05 * 0.05;
  const double exact = 2.0 * std::sqrt(1e5 / mass) * std::sin(std::numbers::pi / 10.0);
  EXPECT_NEAR(2.0 * std::numbers::pi / period / exact, 1.0, 0.001);
}

TEST(Bond, EnergyOfABreakingClusterIsAccountedFor) {
  Script script;
  expect_ok(script.run(
      cluster("compute er all erotate/sphere\n"
              "variable turn equal c_er*1.25\n"  // a disc has ½mr², LIGGGHTS' compute takes 0.4
              "variable sum equal ke+v_turn+f_breaks[5]+f_breaks[6]+f_breaks[7]+f_breaks[8]+"
              "f_breaks[9]\nfix p all ave/time 1 1 1500 v_sum file sum.txt\nrun 1500\n")));
  std::istringstream sums(script.file("sum.txt"));
  std::string line;
  std::vector<double> sum;
  while (std::getline(sums, line)) {
    double step = 0.0, v = 0.0;
    if (std::istringstream(line) >> step >> v) sum.push_back(v);
  }
  ASSERT_GE(sum.size(), 2U);
  EXPECT_NEAR(sum.back() / sum.front(), 1.0, 0.01);
}

/// Tip deflection of a clamped beam of discs under a force at its end, at rest.
double cantilever(const std::string& model_name, int discs, double force) {
  std::string text = head();
  for (int i = 0; i < discs; ++i) text += disc(0.1 + 0.05 * i, 0.5);
  std::ostringstream load;
  load << "group clamp id 1\ngroup tip id " << discs
       << "\ngroup beam subtract all clamp\nfix move beam nve/sphere\n"
          "fix pull tip addforce 0.0 "
       << force
       << " 0.0\nfix slow all viscous 8.0\nfix flat all enforce2d\nfix still clamp freeze\n"
          "timestep 5e-5\nrun 160000\n";
  Script script;
  expect_ok(
      script.run(text + "set type 1 diameter 0.05 density 1000\n" +
                 test::replaced(model({1e5, 1e5, 1e3, 1e9, 0.5}), "bond/contact", model_name) +
                 kBonds + load.str() + kFinalState));
  const std::vector<double> state = values(script.file("state.txt"));
  return state[6 * (discs - 1) + 2] - 0.5;  // id x y …
}

TEST(ParallelBond, ACantileverBendsLikeABeam) {
  // EI = K_n^b l I/A, I/A = R̄²/3; clamped at the first disc's centre: F L³/3EI + F L/(K_t^b l), the
  // bonds' joints in the middle between the discs: sum over them.
  const int discs = 10;
  const double l = 0.05, r = 0.025, k = 1e5, force = 0.05;
  double exact = 0.0;
  for (int i = 0; i < discs - 1; ++i) {
    const double arm = (discs - 1 - i - 0.5) * l;  // of the force about the joint
    exact += force * arm * arm / (k * r * r / 3.0) + force / k;
  }
  EXPECT_NEAR(cantilever("bond/parallel", discs, force) / exact, 1.0, 0.02);
}

TEST(BondCreate, ByTypeAndByList) {
  const std::string three = head() + disc(0.4, 0.5) + disc(0.5, 0.5) + disc(0.6, 0.5) +
                            "set type 1 diameter 0.1 density 1000\n" + model({});
  const std::string end = "fix breaks all bond/breaks every 1 file breaks.csv\nrun 1\n";
  Script script;
  auto job = script.run(three + "fix make all bond/create gap 1e-6\n" + end);
  EXPECT_NE(job.output.find("bonds created: 2"), std::string::npos) << job.output;
  job = script.run(
      three + "shell echo 2 1 > list.txt\nfix make all bond/create gap 1e-6 list list.txt\n" + end);
  EXPECT_NE(job.output.find("bonds created: 1"), std::string::npos) << job.output;
  job = script.run(three + "fix make all bond/create gap 1e-6 types 1 1\n" + end);
  EXPECT_NE(job.output.find("bonds created: 2"), std::string::npos) << job.output;
  job = script.run(
      three + "shell echo 1 3 > list.txt\nfix make all bond/create gap 1e-6 list list.txt\n" + end);
  EXPECT_NE(job.exit_code, 0);
  EXPECT_NE(job.output.find("1 of the 1 listed pairs are no neighbours"), std::string::npos)
      << job.output;
}

struct Refused {
  const char* name;
  const char *from, *to;
  const char* message;
};
class BondRefusal : public testing::TestWithParam<Refused> {};

TEST_P(BondRefusal, SaysWhyAndWhatToDo) {
  Script script;
  const Refused& p = GetParam();
  const auto job = script.run(test::replaced(pulled_pair({}, "0 0 0"), p.from, p.to));
  EXPECT_NE(job.exit_code, 0);
  EXPECT_NE(job.output.find(p.message), std::string::npos) << job.output;
}

INSTANTIATE_TEST_SUITE_P(
    All, BondRefusal,
    testing::Values(
        Refused{"stretch", "bondTensileStrength peratomtypepair 1 20",
                "bondTensileStrength peratomtypepair 1 2e4", "Raise bondNormalStiffness or lower"},
        Refused{"newton", "newton off", "newton on", "newton pair off"},
        Refused{"map", "atom_modify map array", "", "needs 'atom_modify map array'"},
        Refused{"ghosts", "communicate single vel yes", "", "requires ghost atoms store velocity"},
        Refused{"exponent", "ledger on", "exponent 2", "exponent is 1 (linear) or 1.5 (Hertz)"},
        Refused{"gap", "bond/create gap 1e-6", "bond/create types 1 1", "needs 'gap G'"},
        Refused{"word", "bond/create gap 1e-6", "bond/create gap 1e-6 glue 3", "knows no 'glue'"},
        Refused{"file", "every 100 file breaks.csv", "every 100 file no/such/folder.csv",
                "cannot be written"}),
    [](const auto& info) { return info.param.name; });

TEST(BondRefusal, OfABoxInWhichAPairMeetsThroughBothSides) {
  Script script;
  const auto job = script.run(head("p f p", "0 0.22 0 1") + disc(0.05, 0.5) + disc(0.15, 0.5) +
                              "set type 1 diameter 0.1 density 1000\n" + model({}) + kBonds +
                              "timestep 1e-5\nrun 1\n");
  EXPECT_NE(job.exit_code, 0);
  EXPECT_NE(job.output.find("two particles can meet there through both sides"), std::string::npos)
      << job.output;
}

TEST(BondTimeStep, PrintsItsLimitsFitsAndRefuses) {
  const std::string pair = pulled_pair({1e5, 5e4, 20.0, 1e9, 0.5}, "0 0 0");
  const auto with = [&](const std::string& line, const std::string& step) {
    return test::replaced(test::replaced(pair, "timestep 1e-5\n", "timestep " + step + "\n"),
                          "run 2500\n", line + "\nrun 10\nprint \"step is $(dt)\"\n");
  };
  Script script;
  auto job = script.run(with("fix limits all bond/timestep lambda 0.1", "1e-5"));
  expect_ok(job);
  // m = 7.854 kg, k = 1e5 N/m, ξ = ½: √(m/k) 0.618 = 5.477e-3 s
  EXPECT_NE(job.output.find("damped springs, Eq 12        5.4772e-03 s"), std::string::npos)
      << job.output;
  EXPECT_NE(job.output.find("types 1 and 1, damped springs, Eq 12 binds"), std::string::npos);
  job = script.run(with("fix limits all bond/timestep lambda 0.1", "1e-3"));
  EXPECT_NE(job.exit_code, 0);
  EXPECT_NE(job.output.find("take at most 5.4772e-04 s"), std::string::npos) << job.output;
  job = script.run(with("fix limits all bond/timestep lambda 0.1 fit 0.003", "1e-3"));
  expect_ok(job);
  EXPECT_NE(job.output.find("step is 0.0005"), std::string::npos) << job.output;  // 0.003 / 6
}

}  // namespace
