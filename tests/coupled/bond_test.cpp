// SPDX-License-Identifier: GPL-2.0-or-later
/// pair_style gran model bond/contact and bond/parallel in the real LIGGGHTS: breaks to the step,
/// ranks, restart, periodic sides, strength of a lattice, energy, bending.
#include "tests/support/bond_script.h"

#include <cmath>
#include <numbers>

namespace {

using namespace test;

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
std::string cluster(const std::string& bond, const std::string& then) {
  std::string discs;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 25; ++i)
      discs += disc(0.13 + 0.03 * i + 5e-5 * std::sin(7.0 * i + 3.1 * j),
                    0.2 + 0.03 * j + 5e-5 * std::cos(5.0 * j + 2.3 * i));
  return head() + discs +
         "set group all diameter 0.03 density 1000\n"
         "velocity all ramp vx -1 1.5 x 0 1 units box\nvelocity all ramp vy -1 2 x 0 1 units "
         "box\n" +
         model({1e5, 5e4, 60.0, 30.0, 0.05}, bond) + replaced(kBonds, "gap 1e-6", "gap 3e-4") +
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

/// What both bonds promise alike.
class EachBond : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Kinds, EachBond, testing::Values("bond/contact", "bond/parallel"),
                         [](const auto& info) {
                           return std::string(info.param) == "bond/contact" ? "contact"
                                                                            : "parallel";
                         });

TEST_P(EachBond, ClusterBreaksAlikeOnAnyNumberOfRanks) {
  std::vector<std::vector<std::vector<std::string>>> events;
  std::vector<std::vector<double>> states;
  for (const int ranks : {1, 2, 4}) {
    Script script;
    expect_ok(script.run(cluster(GetParam(), "run 11000\n" + kFinalState), ranks));
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
    double difference = 0.0;
    for (std::size_t k = 0; k < states[0].size(); ++k)
      difference = std::max(difference, std::abs(states[other][k] - states[0][k]) /
                                            std::max(1.0, std::abs(states[0][k])));
    EXPECT_LT(difference, 1e-10);
  }
}

TEST_P(EachBond, RestartInTheMiddleOfAFractureIsBitIdentical) {
  Script script;
  expect_ok(
      script.run(cluster(GetParam(), "run 700\nwrite_restart half.rst\nrun 700\n" + kFinalState)));
  const std::string state = script.file("state.txt"), breaks = script.file("breaks.csv");
  // the same lines, but the particles come from the file; bond/create must not bond them again
  std::string again = cluster(GetParam(), "run 700\n" + kFinalState);
  const std::size_t from = again.find("region box"), to = again.find("fix contactNormalStiffness");
  again = again.substr(0, from) +
          "read_restart half.rst\nneighbor 0.02 bin\nneigh_modify delay 0\n" + again.substr(to);
  expect_ok(script.run(again, 1, "in.again"));
  EXPECT_EQ(script.file("state.txt"), state);
  EXPECT_EQ(script.file("breaks.csv"), breaks);
}

TEST_P(EachBond, DimerCrossesAPeriodicSideAlikeOnTwoRanks) {
  std::vector<std::string> states;
  for (const int ranks : {1, 2}) {
    Script script;
    expect_ok(
        script.run(head("p f p") + disc(0.45, 0.5) + disc(0.55, 0.5) +
                       "set type 1 diameter 0.1 density 1000\nvelocity all set 5.0 0.1 0 units "
                       "box\nset atom 2 vx 5.2\n" +
                       model({1e5, 5e4, 1e3, 1e9}, GetParam()) + kBonds +
                       "fix move all nve/sphere\nfix flat all enforce2d\ntimestep 1e-5\n"
                       "run 60000\n" +
                       kFinalState,
                   ranks));
    EXPECT_TRUE(rows(script.file("breaks.csv")).empty());
    states.push_back(script.file("state.txt").substr(script.file("state.txt").find("ITEM: ATOMS")));
  }
  EXPECT_EQ(states[0], states[1]);
}

/// The largest magnitude in the second column of what `fix ave/time` wrote.
double largest(const std::string& series) {
  std::istringstream lines(series);
  std::string line;
  double most = 0.0;
  while (std::getline(lines, line)) {
    double step = 0.0, value = 0.0;
    if (std::istringstream(line) >> step >> value) most = std::max(most, std::abs(value));
  }
  return most;
}

TEST(Bond, ATriangularLatticeHasItsStrengthAcrossItsRows) {
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
  EXPECT_NEAR(largest(script.file("force.txt")) / width / (std::sqrt(3.0) * strength / l), 1.0,
              0.01);
  EXPECT_FALSE(rows(script.file("breaks.csv")).empty());
}

TEST(Bond, ATriangularLatticeHasItsStrengthAlongItsRows) {
  // Pulled along its rows, free sides, no shear stiffness: σ_t = (F_bn/k_n l) E, E = 2 k_n/√3. The
  // last discs of both ends of all rows are moved with one strain rate.
  const int in_row = 16, rows_of_discs = 8;
  const double l = 0.05, rise = l * std::sqrt(3.0) / 2.0, strength = 20.0, rate = 0.0125;
  std::string text = head("f f p", "0 1 0 1");
  std::ostringstream pull, ends[4];
  for (int j = 0; j < rows_of_discs; ++j)
    for (int i = 0; i < in_row; ++i) text += disc((i + 1.25 + 0.5 * (j % 2)) * l, 0.3 + j * rise);
  for (int j = 0; j < rows_of_discs; ++j) {
    ends[j % 2] << ' ' << j * in_row + 1;
    ends[2 + j % 2] << ' ' << (j + 1) * in_row;
  }
  pull.precision(17);
  for (int e = 0; e < 4; ++e) {
    const double place = (e < 2 ? 0 : in_row - 1) + 0.5 * (e % 2) - 0.5 * in_row;  // in l
    pull << "group end" << e << " id" << ends[e].str() << "\nfix m" << e << " end" << e
         << " move linear " << rate * place * l << " NULL NULL\n";
  }
  pull << "group ends union end2 end3\ngroup all_ends union end0 end1 end2 end3\n"
       << "group inner subtract all all_ends\nfix move inner nve/sphere\nfix flat all enforce2d\n"
       << "timestep 1e-5\ncompute f ends reduce sum fx\n"
       << "fix p all ave/time 1 1 1 c_f file force.txt\nrun 40000\n";
  Script script;
  expect_ok(script.run(text + "set type 1 diameter 0.05 density 1000\n" +
                       model({1e5, 0.0, strength, 1e9, 0.5}) + kBonds + pull.str()));
  const double height = rows_of_discs * rise;
  EXPECT_NEAR(largest(script.file("force.txt")) / height / (2.0 / std::sqrt(3.0) * strength / l),
              1.0, 0.01);
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

TEST_P(EachBond, EnergyOfABreakingClusterIsAccountedFor) {
  Script script;
  expect_ok(script.run(
      cluster(GetParam(),
              "compute er all erotate/sphere\n"
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
  expect_ok(script.run(text + "set type 1 diameter 0.05 density 1000\n" +
                       model({1e5, 1e5, 1e3, 1e9, 0.5}, model_name) + kBonds + load.str() +
                       kFinalState));
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

}  // namespace
