// SPDX-License-Identifier: GPL-2.0-or-later
/// The commands about bonds in the real LIGGGHTS: what they make, print and refuse.
#include "tests/support/bond_script.h"

namespace {

using namespace test;

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
  for (const auto& [notch, bonds] :
       {std::pair{"notch 0.45 0.4 0.45 0.6", "bonds created: 1"},
        std::pair{"notch 0.45 0.51 0.45 0.6", "bonds created: 2"},
        std::pair{"notch 0.45 0.4 0.45 0.6 notch 0.5 0.4 0.6 0.6", "bonds created: 0"}}) {
    job = script.run(three + "fix make all bond/create gap 1e-6 " + notch + "\n" + end);
    EXPECT_NE(job.output.find(bonds), std::string::npos) << notch << "\n" << job.output;
  }
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
  const auto job = script.run(replaced(pulled_pair({}, "0 0 0"), p.from, p.to));
  EXPECT_NE(job.exit_code, 0);
  EXPECT_NE(job.output.find(p.message), std::string::npos) << job.output;
}

INSTANTIATE_TEST_SUITE_P(
    All, BondRefusal,
    testing::Values(
        Refused{"stretch", "bondTensileStrength peratomtypepair 1 20",
                "bondTensileStrength peratomtypepair 1 2e4", "Raise bondNormalStiffness or lower"},
        Refused{"newton", "newton off", "newton on", "newton pair off"},
        Refused{"pair", "pair_style gran model bond/contact ledger on",
                "fix kn all property/global kn peratomtypepair 1 1e5\n"
                "fix kt all property/global kt peratomtypepair 1 1e5\n"
                "fix gn all property/global gamman peratomtypepair 1 1\n"
                "fix gt all property/global gammat peratomtypepair 1 1\n"
                "pair_style gran model hooke/stiffness",
                "this one makes no bonds"},
        Refused{"map", "atom_modify map array", "", "needs 'atom_modify map array'"},
        Refused{"ghosts", "communicate single vel yes", "", "requires ghost atoms store velocity"},
        Refused{"exponent", "ledger on", "exponent 2", "exponent is 1 (linear) or 1.5 (Hertz)"},
        Refused{"gap", "bond/create gap 1e-6", "bond/create types 1 1", "needs 'gap G'"},
        Refused{"word", "bond/create gap 1e-6", "bond/create gap 1e-6 glue 3", "knows no 'glue'"},
        Refused{"point", "gap 1e-6", "gap 1e-6 notch 0 1 0 1", "its ends are the same point"},
        Refused{"notch", "gap 1e-6", "gap 1e-6 notch 0 1 0", "'notch' lacks its value"},
        Refused{
            "listed", "fix make all bond/create gap 1e-6",
            "shell echo 1 2 > list.txt\nfix make all bond/create gap 1e-6 list list.txt notch 0 0 "
            "1 1",
            "leave what the notch cuts out of the list"},
        Refused{"number", "gap 1e-6", "gap 1.2.3", "'gap 1.2.3': give a number"},
        Refused{"whole", "every 100 file", "every 100x file", "'every 100x': give a whole number"},
        Refused{"pipe", "fix make all bond/create gap 1e-6",
                "shell mkfifo pipe\nfix make all bond/create gap 1e-6 list pipe",
                "list pipe: is no regular file (a pipe or a device?)"},
        Refused{"deleted", "run 2500\n", "run 200\nshell rm breaks.csv\nrun 200\n",
                "breaks.csv was deleted while the run was writing it"},
        Refused{"file", "every 100 file breaks.csv", "every 100 file no/such/folder.csv",
                "cannot be written"}),
    [](const auto& info) { return info.param.name; });

/// K δ = 200 N press when the bond of K/5 is made: it is without force at a gap of 4 δ = 8 mm, and
/// breaks by its 20 N 1 mm further on. Pulled at 1 m/s it has 11 mm behind it then.
TEST(BondCreate, UnderPressureBreaksWhereItsLawSays) {
  Script script;
  const std::string pressed =
      replaced(pulled_pair({.stiffness = 2e4}, "1 0 0"), disc(0.55, 0.5), disc(0.548, 0.5));
  const auto refused = script.run(pressed);
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_NE(refused.output.find("write 'run 0' after this fix"), std::string::npos)
      << refused.output;
  expect_ok(script.run(replaced(pressed, "run 2500\n", "run 0\nrun 2500\n")));
  const auto breaks = rows(script.file("breaks.csv"));
  ASSERT_EQ(breaks.size(), 1U);
  EXPECT_EQ(breaks[0][4], "tension");
  EXPECT_NEAR(std::stod(breaks[0][1]), 0.011, 2e-5);  // two steps
}

TEST(BondCreate, WarnsWhereThereAreNoneOrTheStepIsTooLong) {
  Script script;
  const std::string none = "has made no bonds", step = "which will break by itself";
  auto job = script.run(pulled_pair({}, "0 0 0"));
  EXPECT_EQ(job.output.find(none), std::string::npos) << job.output;
  EXPECT_EQ(job.output.find(step), std::string::npos) << job.output;
  job = script.run(replaced(pulled_pair({}, "0 0 0"), disc(0.55, 0.5), disc(0.56, 0.5)));
  EXPECT_NE(job.output.find(none), std::string::npos) << job.output;
  job = script.run(replaced(pulled_pair({}, "0 0 0"), "timestep 1e-5", "timestep 1e-2"));
  EXPECT_NE(job.output.find(step), std::string::npos) << job.output;
}

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
    return replaced(replaced(pair, "timestep 1e-5\n", "timestep " + step + "\n"), "run 2500\n",
                    line + "\nrun 10\nprint \"step is $(dt)\"\n");
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
