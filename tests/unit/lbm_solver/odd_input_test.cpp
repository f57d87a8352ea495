// SPDX-License-Identifier: GPL-2.0-or-later
/// What users give by mistake: it is refused with its place, or warned of.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/image_file.h"
#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/plan.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

class OddInput : public testing::Test {
 protected:
  /// A box of 10 × 8 cells of 1 mm, with a text at its end.
  std::string scene(const std::string& rest) const {
    return folder_.write("scene.toml",
                         "[box]\nsize = [0.010, 0.008]\n[fluid]\ndensity = 1000.0\n"
                         "kinematic_viscosity = 1e-6\nvelocity_scale = 1e-3\n[numerics]\n"
                         "cell = 0.001\n[run]\nend_time = 1.0\n" +
                             rest);
  }
  /// Why a scene is refused; empty: it is not.
  std::string refusal(const std::string& rest) const {
    try {
      const Scene s = read_scene({scene(rest)});
      make_fluid(s, make_plan(s));
      return {};
    } catch (const InputError& error) {
      return error.what();
    }
  }
  std::string warnings(const std::string& rest) const {
    return fmt::format("{}", fmt::join(make_plan(read_scene({scene(rest)})).warnings, "\n"));
  }
  test::TemporaryFolder folder_;
};

void expect_in(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << words << " not in: " << text;
}

const std::string kInlet =
    "[[boundary]]\nside = \"left\"\nkind = \"velocity\"\nvelocity = [0.001, 0.0]\n"
    "[[boundary]]\nside = \"right\"\nkind = \"outflow\"\n[[boundary]]\nside = \"top\"\n"
    "kind = \"velocity\"\nvelocity = [0.001, 0.0]\n";

TEST_F(OddInput, SolidsThatLeaveNoFluidAreRefused) {
  const std::string words = "no cell is left to the fluid";
  expect_in(refusal("[[obstacle]]\ncentre = [0.005, 0.004]\ndiameter = 1e6"), words);
  expect_in(refusal("[[obstacle]]\nfrom = [0, 0]\nto = [0.010, 0.008]"), words);
  expect_in(refusal("[[obstacle]]\nfrom = [0, 0]\nto = [0.005, 0.008]\n"
                    "[[obstacle]]\nfrom = [0.005, 0]\nto = [0.010, 0.008]"),
            words);
  std::ofstream(folder_.path() + "/rock.raw", std::ios::binary) << std::string(80, '\xff');
  const std::string image =
      "[[obstacle]]\nimage = \"rock.raw\"\nraw_size = [10, 8]\nraw_type = \"uint8\"\n"
      "voxel = 0.001\nthreshold = 128\n";
  expect_in(refusal(image), words);
  EXPECT_EQ(refusal(image + "solid = \"below\""), "");
  EXPECT_EQ(refusal("[[obstacle]]\nfrom = [0, 0]\nto = [0.010, 0.007]"), "") << "one row is left";
}

TEST_F(OddInput, OfManyWarningsOfAKindAFewAreSaid) {
  std::string heap, dust;
  for (int i = 0; i < 300; ++i) heap += "[[obstacle]]\ncentre = [0.005, 0.004]\ndiameter = 0.005\n";
  const std::string said = warnings(heap);
  EXPECT_EQ(std::ranges::count(said, '\n'), 5) << said;
  expect_in(said, "and 44845 more pairs of obstacles");  // 300 · 299 / 2 less 5
  for (int i = 0; i < 7; ++i)
    dust += fmt::format("[[obstacle]]\ncentre = [{}, 0.004]\ndiameter = 1e-3\n", 1e-3 * (i + 1.5));
  expect_in(warnings(dust), "and 2 more obstacles whose flow is not resolved");
}

TEST_F(OddInput, TablesOfAnySystemAreTheSame) {
  const auto factors = [&](const std::string& content) {
    folder_.write("in.csv", content);
    return read_scene({scene(kInlet + "table = \"in.csv\"")}).boundaries.back().table.factors;
  };
  const std::vector<double> good{0.5, 1.0};
  EXPECT_EQ(factors("time,factor\n0,0.5\n1,1\n"), good);
  EXPECT_EQ(factors("time,factor\r\n0,0.5\r\n1,1\r\n"), good);
  EXPECT_EQ(factors("\xef\xbb\xbftime,factor\n0,0.5\n1,1"), good);
  EXPECT_EQ(factors("time, factor\n 0 ,\t0.5\n\n+1, 1.0e0\n\n"), good);
  const auto refused = [&](const std::string& content) {
    folder_.write("in.csv", content);
    return refusal(kInlet + "table = \"in.csv\"");
  };
  expect_in(refused("time,factor\n0,0x10\n1,1\n"), "line 2: '0,0x10' is not two finite numbers");
  expect_in(refused("time\tfactor\n0\t1\n"), "begins with 'time\\tfactor'");
  expect_in(refused("\xff\xfet\n"), "begins with '\\xff\\xfet'");
  expect_in(refused(""), "begins with ''");
  folder_.write("bed.csv", "\xef\xbb\xbfx, y, diameter\r\n0.005,0.004,0.001\r\n");
  EXPECT_EQ(read_scene({scene("[grains]\nfile = \"bed.csv\"")}).obstacles.size(), 1U);
}

TEST_F(OddInput, TablesThatDoNotReachAreWarnedOf) {
  const auto said = [&](const std::string& content) {
    folder_.write("in.csv", content);
    return warnings(kInlet + "table = \"in.csv\"");
  };
  EXPECT_EQ(said("time,factor\n0,0.5\n1,1\n"), "");
  EXPECT_EQ(said("time,factor\n0.2,0\n0.3,1\n0.4,1\n"), "") << "nothing, then a plateau";
  expect_in(said("time,factor\n0.2,0.5\n1,1\n"), "table of boundary 3 begins at 0.2 s");
  expect_in(said("time,factor\n0,0.5\n0.6,1\n"),
            "ends at 0.6 s, the run at 1 s: from then on it keeps its last factor, 1");
  const auto profile = [&](const std::string& content) {
    folder_.write("in.csv", content);
    return kInlet + "profile_table = \"in.csv\"";
  };
  expect_in(refusal(profile("x,factor\n1,0\n9,1\n")), "from x = 1 to 9 m, boundary 3 lies from 0");
  expect_in(warnings(profile("x,factor\n0,0\n0.004,1\n")), "beyond its places the last factor");
  EXPECT_EQ(warnings(profile("x,factor\n0,0\n0.009,1\n")), "");
}

TEST_F(OddInput, TablesOfAnotherUnitAreWarnedOf) {
  const std::string periodic = "table = \"in.csv\"\nrepeat = \"periodic\"";
  const auto table = [&](const std::string& content, const std::string& keys) {
    folder_.write("in.csv", content);
    return kInlet + keys;
  };
  // ns taken for s: a step is 0.1 s here
  expect_in(refusal(table("time,factor\n0,1\n5e-7,0\n1e-6,1\n", periodic)),
            "goes from 0 to 1e-06 s, 1e-05 fluid steps of 0.1 s, of which a period needs at least");
  EXPECT_EQ(refusal(table("time,factor\n0,1\n2,0\n4,1\n", periodic)), "");
  expect_in(warnings(table("time,factor\n0,0\n1e-6,1\n2e-6,1\n", "table = \"in.csv\"")),
            "what it says in between is lost; are its times in seconds?");
  // mm taken for m
  expect_in(warnings(table("x,factor\n0,0\n10,1\n", "profile_table = \"in.csv\"")),
            "of the table only 0.1 % lies on it; its places are in metres, are they in mm?");
  expect_in(warnings(table("x,factor\n0,0\n1e4,1\n", "profile_table = \"in.csv\"")),
            "are they in µm?");
  // ns that end behind the run of 1 s, before it, and in its first moment
  const auto once = [&](const std::string& content) {
    return warnings(table("time,factor\n" + content, "table = \"in.csv\""));
  };
  expect_in(once("0,0\n5e8,0.5\n1e9,1\n"),
            "goes from 0 to 1e+09 s, the run from 0 to 1 s: only 1e-07 % of it acts; its times are "
            "in seconds, are they in ns?");
  expect_in(once("2,0\n3,1\n"), "all of it lies behind the run, which keeps its first line");
  expect_in(once("-3,0\n-2,1\n0,1\n"), "all of it lies before the run, which keeps its last");
  EXPECT_EQ(once("0,0\n9,1\n"), "") << "a part of a longer history";
  EXPECT_EQ(once("0,0\n0.5,1\n1e6,1\n"), "") << "a value that stays";
  // minutes for seconds; a soft start is none
  const std::string minutes = "ends at 0.015 s, after 1.5 % of the run, and from then on has its ";
  const auto short_one = [&](const std::string& content) {
    Scene s = read_scene({scene(table("time,factor\n" + content, "table = \"in.csv\""))});
    s.numerics.time_step = 1e-3;
    return fmt::format("{}", fmt::join(make_plan(s).warnings, "\n"));
  };
  expect_in(short_one("0,0\n0.005,1\n0.010,1\n0.015,0\n0.016,0\n"), minutes + "last factor, 0");
  expect_in(short_one("0,1\n0.015,0\n"), "are they in minutes or hours?");
  EXPECT_EQ(short_one("0,0\n0.015,1\n0.016,1\n"), "") << "a soft start";
  EXPECT_EQ(short_one("0,0\n0.02,1\n0.025,0\n"), "") << "a pulse";
  expect_in(warnings(table("time,factor\n0,1\n2e6,0\n4e6,1\n", periodic)),
            "it ends after 2.5e-07 of the period; its times are in seconds, are they in µs?");
  Scene quick =
      read_scene({scene(table("time,factor\n0,0\n5e-4,1\n6e-4,1\n", "table = \"in.csv\""))});
  quick.numerics.time_step = 1e-5;
  expect_in(fmt::format("{}", fmt::join(make_plan(quick).warnings, "\n")),
            "it is over after 0.05 % of the run; its times are in seconds");
  expect_in(warnings(table("time,factor\n0,1\n4,1\n", "table = \"in.csv\"\nfrequency = 0.25")),
            "the table of boundary 3 stands beside a frequency: the value is multiplied by both");
}

TEST_F(OddInput, SensorsThatMeasureNothingAreNamed) {
  expect_in(refusal("[[sensor]]\nname = \"a\"\nkind = \"line\"\nfrom = [0.001, 0.001]\n"
                    "to = [0.001, 0.001]"),
            "sensor \"a\": is a line of no length");
  const std::string side = "[[sensor]]\nname = \"a\"\nkind = \"side\"\nside = \"left\"";
  EXPECT_EQ(warnings(side), "");
  const std::string file = test::replaced(test::read_file(scene(side)), "[0.010, 0.008]\n",
                                          "[0.010, 0.008]\nsides_x = \"periodic\"\n");
  const Plan plan = make_plan(read_scene({folder_.write("scene.toml", file)}));
  ASSERT_EQ(plan.warnings.size(), 1U);
  expect_in(plan.warnings[0], "sensor \"a\": its side is periodic");
}

TEST_F(OddInput, ABrokenImageIsRefused) {
  const auto problem = [&](const std::string& name, const std::string& bytes) -> std::string {
    const std::string path = folder_.path() + "/" + name;
    std::ofstream(path, std::ios::binary) << bytes;
    try {
      read_image(path, {});
      return {};
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  const auto array = [](const std::string& type, const std::string& shape) {
    const std::string head = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape;
    return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(head.size() + 1) + '\0' + head +
           '}' + std::string(6, '\1');
  };
  EXPECT_EQ(problem("a.npy", array("|u1", "(2, 3)")), "");
  expect_in(problem("a.npy", array("|u1", "(-2, -3)")), "has a size of -2");
  expect_in(problem("a.npy", array("|O", "(2, 3)")), "numbers of type '|O';");
  const std::string whole =
      test::read_file(BPLBM_SOURCE_DIR "/tests/unit/lbm_solver/pictures/grey8.png");
  EXPECT_EQ(problem("a.png", whole), "");
  constexpr std::size_t kEnd = 12;  // bytes of IEND
  expect_in(problem("a.png", whole.substr(0, whole.size() - kEnd)), "is no whole .png file");
}

TEST_F(OddInput, ATableThatWasDamagedStopsARestart) {
  const std::string path = folder_.path() + "/t.csv", columns = "time [s],x [m]";
  const auto after = [&](const std::string& content) {
    folder_.write("t.csv", content);
    CsvWriter(path, columns, 2.5).flush();
    return test::read_file(path);
  };
  const std::string good = columns + "\n1,0.5\n2,\n";
  EXPECT_EQ(after(good + "3,1\n"), good) << "later rows come again";
  EXPECT_EQ(after(good + "2,0."), good) << "a kill has cut off the last";
  for (const char* bad : {"2,1,1", "2", "\x03\x81q", "2,a", ",1"}) try {
      after(good + bad + "\n");
      ADD_FAILURE() << "accepted: " << bad;
    } catch (const InputError& error) {
      expect_in(error.what(), "t.csv: line 4: is damaged: it is no row of this table");
    }
}

TEST_F(OddInput, OfACoupledSceneIsNamed) {
  const std::string good = test::good_scene();
  const auto said = [](const std::string& file) {
    return fmt::format("{}", fmt::join(make_plan(read_scene({file})).warnings, "\n"));
  };
  EXPECT_EQ(said(folder_.write("scene.toml", good)), "");
  std::filesystem::create_directory(folder_.path() + "/my scenes");
  expect_in(said(folder_.write("my scenes/scene.toml", good)),
            "my scenes\" has a blank in its name");
  const std::string overlay = folder_.write("overlay.toml", "[run]\nend_time = 0.5\n");
  EXPECT_TRUE(make_plan(read_scene({folder_.write("scene.toml", good), overlay})).warnings.empty());
  expect_in(said(folder_.write("scene.toml", test::replaced(good, "[coupling]",
                                                            "[coupling]\nfluid_steps = 1000"))),
            "tested are up to 10");
  EXPECT_EQ(said(folder_.write("scene.toml",
                               test::replaced(good, "[coupling]", "[coupling]\nfluid_steps = 10"))),
            "");
  try {
    said(folder_.write("scene.toml", test::replaced(good, "= 2.0e5", "= 1e300")));
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    expect_in(error.what(), "particles.contact_stiffness = 1e+300 N/m: needs");
  }
}

}  // namespace
