// SPDX-License-Identifier: GPL-2.0-or-later
/// Files that a scene names, and variables that it gives to the solid's script.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/script_variables.h"
#include "lbm_solver/solver/plan.h"
#include "tests/support/script_words.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

std::string refusal(const std::vector<std::string>& files) {
  try {
    read_scene(files);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}
void expect_in(const std::string& text, const std::string& word) {
  EXPECT_NE(text.find(word), std::string::npos) << word << " not in: " << text;
}

class SceneFiles : public testing::Test {
 protected:
  std::string pipe(const std::string& name) const {
    const std::string path = folder_.path() + "/" + name;
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    return path;
  }
  std::string scene(const std::string& more = "") const {
    return folder_.write("scene.toml", test::good_scene() + more);
  }
  test::TemporaryFolder folder_;
};

TEST_F(SceneFiles, APipeOrADeviceIsNoScene) {
  expect_in(refusal({pipe("pipe.toml")}), "pipe.toml: is no regular file (a pipe or a device?)");
  expect_in(refusal({scene(), "/dev/zero"}), "/dev/zero: is no regular file");
  expect_in(refusal({folder_.path()}), "is a folder, not a file");
}

TEST_F(SceneFiles, GrainsComeFromATableOfFiniteNumbers) {
  const std::string text = "\n[grains]\nfile = \"grains.csv\"\n";
  const auto with = [&](const std::string& rows) {
    folder_.write("grains.csv", rows);
    return refusal({scene(text)});
  };
  EXPECT_EQ(with("x,y,diameter\n0.01,0.01,0.002\n"), "accepted");
  for (const char* row : {"nan,0.01,0.002", "0.01,inf,0.002", "0.01,0.01,nan", "0.01,0.01,-0.002",
                          "0.01,0.01", "0.01,0.01,0.002,1"})
    expect_in(with(std::string("x,y,diameter\n0.01,0.02,0.002\n") + row + "\n"),
              std::string("line 3: '") + row + "' is not 3 finite numbers");
  expect_in(with(std::string(100000, 'a')), "begins with '" + std::string(60, 'a') + "…'");
  std::remove((folder_.path() + "/grains.csv").c_str());
  pipe("grains.csv");
  expect_in(refusal({scene(text)}), "grains.file = \"grains.csv\": is no regular file");
  expect_in(refusal({scene("\n[grains]\nfile = \"/dev/zero\"\n")}), "is no regular file");
}

std::string with_variable(const std::string& line) {
  return test::replaced(test::good_scene(), "[particles.variables]",
                        "[particles.variables]\n" + line);
}

TEST_F(SceneFiles, NamesOfTheProgramsAreReserved) {
  for (const char* name : {"scene_folder", "out_folder", "restart_file", "checkpoint", "restart",
                           "x_lo", "solid_step", "particle1_x", "contact_stiffness"}) {
    const std::string file =
        folder_.write("scene.toml", with_variable(std::string(name) + " = \"/tmp/evil\""));
    expect_in(refusal({file}), std::string("particles.variables.") + name + " is a name that the");
    expect_in(refusal({scene(), folder_.write("over.toml", std::string("[particles.variables]\n") +
                                                               name + " = 1\n")}),
              std::string("over.toml:2: particles.variables.") + name);
  }
}

TEST_F(SceneFiles, EveryNameThatTheFluidOffersIsReserved) {
  for (const bool flat : {true, false}) {
    const Scene s =
        read_scene({std::string(BPLBM_SOURCE_DIR "/cases/") +
                    (flat ? "settling_disc/scene.toml" : "ten_cate_sphere/scene.toml")});
    for (const auto& v : make_handshake(s, make_plan(s)).variables)
      EXPECT_NE(is_reserved_variable(v.name), s.particles->variables.contains(v.name)) << v.name;
  }
}

TEST_F(SceneFiles, AVariableIsAWordAndAValue) {
  const auto with = [&](const std::string& line) {
    return refusal({folder_.write("scene.toml", with_variable(line))});
  };
  EXPECT_EQ(with("offset = -0.5\nfile = \"grains/bed.txt\"\nparticle1_vx = \"-.1e-3\""),
            "accepted");
  expect_in(with("\"two words\" = 1"), "is no name that a script can use");
  expect_in(with("evil = \"-in\""), "begins with '-', as an option of LIGGGHTS does");
  expect_in(with("empty = \"\""), "is empty");
}

// The words of a script stay what they were, whatever a scene says: quotes, commands, paths.
TEST(ScriptWords, OfASceneAreOneWordEach) {
  std::mt19937 random(1);
  const std::string alphabet = "ab1._-/:,+*= \t\n\r\"'`$(){}&#;|<>\\%@!?~^[]\x01\x7f\xc3\xa4shell";
  const auto text = [&] {
    std::string t;
    for (auto n = random() % 9; n > 0; --n) t += alphabet[random() % alphabet.size()];
    return t;
  };
  int accepted = 0;
  for (int i = 0; i < 200'000; ++i) {
    const std::string t = text();
    if (why_no_script_path(t).empty() && !t.empty()) {
      EXPECT_TRUE(test::is_whole_between_quotes(t)) << t;
    }
    if (!why_no_variable("v", t).empty()) continue;
    ++accepted;
    ASSERT_TRUE(test::is_one_word_in_scripts(t)) << t;
    EXPECT_FALSE(t.starts_with("/") || ("/" + t + "/").find("/../") != std::string::npos) << t;
    EXPECT_TRUE(why_no_script_path(t).empty()) << t;
  }
  EXPECT_GT(accepted, 1000) << "the words are seen, not only refusals";
}

TEST_F(SceneFiles, NoWordOfASceneReachesAShell) {
  const auto with = [&](const std::string& value) {
    return refusal({folder_.write("scene.toml", with_variable("evil = " + value))});
  };
  for (const char* value :
       {"'1\" == 1\" then \"shell touch x'", "'$(id)'", "'`id`'", "\"1\\nshell id\"", "'a b'",
        "'a#'", "'a &'", "'${scene_folder}'", "\"it's\"", "\"\\u0007\""})
    expect_in(with(value), "which a script could read as more than one word");
  for (const char* value : {"'/tmp/evil'", "'../evil'", "'a/../../evil'", "'..'"})
    expect_in(with(value), "leads out of the scene's folder");
}

TEST(Step, OfARunThatGoesOnDoesNotDependOnItsEnd) {
  Scene s = read_scene({BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml"});
  s.end_time = 0.7;
  const Plan before = make_plan(s);
  s.end_time = 1.0;
  const Plan fresh = make_plan(s), after = make_plan(s, before.units.dt);
  EXPECT_NE(fresh.units.dt, before.units.dt) << "the case is chosen so that rounding shows";
  EXPECT_EQ(after.units.dt, before.units.dt);
  EXPECT_EQ(after.wished_step, fresh.wished_step);
  EXPECT_EQ(after.kernel.parameters.tau, before.kernel.parameters.tau);
  const double end = after.interval() * static_cast<double>(after.intervals);
  EXPECT_GE(end, 1.0 * (1.0 - 1e-9));
  EXPECT_LT(end, 1.0 + after.interval());
  EXPECT_EQ(make_plan(s, fresh.units.dt).intervals, fresh.intervals);
}

}  // namespace
