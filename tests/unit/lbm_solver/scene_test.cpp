// SPDX-License-Identifier: GPL-2.0-or-later
#include <gtest/gtest.h>

#include <type_traits>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/plan.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

/// One way to spoil the good scene, and what the message must say.
struct Spoiled {
  std::string name, from, to;
  std::vector<std::string> words;
};

void PrintTo(const Spoiled& s, std::ostream* out) {
  *out << s.name;
}

class BadScene : public testing::TestWithParam<Spoiled> {};

TEST_P(BadScene, IsNamedWithPlaceReasonAndRemedy) {
  const Spoiled& s = GetParam();
  const test::TemporaryFolder folder;
  const std::string file =
      folder.write("scene.toml", test::replaced(test::good_scene(), s.from, s.to));
  try {
    make_plan(read_scene({file}));
    FAIL() << "accepted";
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_EQ(e.exit_code(), 2);
    static_assert(!std::is_base_of_v<protocol::ProtocolError, InputError>,
                  "a mistake in a scene is no error of the exchange");
    EXPECT_NE(text.find("scene.toml"), std::string::npos) << text;
    EXPECT_NE(text.find("; "), std::string::npos) << "no remedy in: " << text;
    for (const auto& word : s.words) EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BadScene,
    testing::Values(
        Spoiled{"unknown_key",
                "depth = 1.0",
                "deepness = 1.0",
                {":7:", "box.deepness", "known here", "depth"}},
        Spoiled{"unknown_table", "[run]", "[extra]\na = 1\n[run]", {"extra", "known"}},
        Spoiled{"wrong_type",
                "density = 1000.0",
                "density = \"heavy\"",
                {"fluid.density", "heavy", "not a number"}},
        Spoiled{"missing_key",
                "kinematic_viscosity = 1e-5",
                "",
                {"fluid.kinematic_viscosity", "missing"}},
        Spoiled{"misspelt_table", "[run]", "[runs]", {":1: run is missing, but there is 'runs'"}},
        Spoiled{"text_for_a_length",
                "size = [0.02, 0.06]",
                "size = [0.02, \"6 cm\"]",
                {"box.size = '6 cm' is not a number; give a number [m]"}},
        Spoiled{"one_length_too_many",
                "size = [0.02, 0.06]",
                "size = [0.02, 0.06, 0.1, 1]",
                {"box.size = [0.02, 0.06, 0.1, 1] is no pair of numbers", "three lengths"}},
        Spoiled{"millimetres_for_metres",
                "diameter = 0.0025",
                "diameter = 2.5",
                {"particles.diameter = 2.5 m is wider than the box (0.02 m)"}},
        Spoiled{"missing_table", "[run]\nend_time = 1.0", "[output2]", {"run", "missing"}},
        Spoiled{"negative_viscosity",
                "= 1e-5",
                "= -1e-5",
                {"kinematic_viscosity", "-1e-05", "positive"}},
        Spoiled{"zero_viscosity", "= 1e-5", "= 0", {"kinematic_viscosity", "positive"}},
        Spoiled{"not_finite", "= 1e-5", "= nan", {"kinematic_viscosity", "nan"}},
        Spoiled{"disc_outside",
                "[[0.01, 0.04]]",
                "[[0.0195, 0.04]]",
                {"particles.start", "0.0195", "outside"}},
        Spoiled{"disc_too_wide",
                "diameter = 0.0025",
                "diameter = 0.025",
                {"particles.diameter", "wider than the box"}},
        Spoiled{"discs_overlap",
                "[[0.01, 0.04]]",
                "[[0.01, 0.04], [0.0112, 0.04]]",
                {"particles.start", "[0.0112, 0.04]", "overlap by 0.0013 m", "0.0025 m"}},
        Spoiled{"unknown_collision",
                "\"trt\"",
                "\"magic\"",
                {"numerics.collision", "bgk, trt, central_moment"}},
        Spoiled{"no_such_kernel",
                "\"trt\"",
                "\"recursive_regularised\"\nprecision = \"single\"",
                {"numerics.collision", "double precision only"}},
        Spoiled{"unknown_term",
                "\"layered_resistance\"",
                "\"holy\"",
                {"numerics.solid_term", "noble_torczynski"}},
        Spoiled{"cell_and_cells",
                "cells_per_diameter = 20",
                "cells_per_diameter = 20\ncell = 1e-4",
                {"numerics.cell", "either"}},
        Spoiled{"no_cell", "cells_per_diameter = 20", "", {"numerics.cell", "missing"}},
        Spoiled{"cell_does_not_fit",
                "cells_per_diameter = 20",
                "cell = 1.3e-4",
                {"box.size", "whole number"}},
        Spoiled{"mach",
                "cells_per_diameter = 20",
                "cells_per_diameter = 20\ntime_step = 1e-3",
                {"numerics.time_step", "0.48", "compressible"}},
        Spoiled{"tau_half", "kinematic_viscosity = 1e-5", "kinematic_viscosity = 1e-12", {"τ"}},
        Spoiled{"few_substeps",
                "timeout = 60.0",
                "substeps = 1\ntimeout = 60.0",
                {"coupling.substeps", "at least 12"}},
        Spoiled{"no_end", "end_time = 1.0", "end_time = 0.0", {"run.end_time", "positive"}},
        Spoiled{"bad_syntax", "[box]", "[box", {":5"}},
        Spoiled{"not_a_pair", "size = [0.02, 0.06]", "size = [0.02]", {"box.size", "pair"}}),
    [](const auto& info) { return info.param.name; });

/// A part of a scene that a test adds, before its last table.
std::string with(const std::string& tables) {
  return tables + "\n[run]";
}
const std::string kInlet = "[[boundary]]\nside = \"left\"\nkind = \"velocity\"\n";

INSTANTIATE_TEST_SUITE_P(
    Places, BadScene,
    testing::Values(
        Spoiled{"boundaries_in_each_other",
                "[run]",
                with(kInlet + "velocity = [0.01, 0]\nto = 0.02\n" + kInlet +
                     "velocity = [0.02, 0]\nfrom = 0.019"),
                {"boundaries 1 and 2 overlap on side \"left\""}},
        Spoiled{"obstacle_outside",
                "[run]",
                with("[[obstacle]]\ncentre = [0.025, 0.03]\ndiameter = 0.009"),
                {"obstacle: [0.025, 0.03]", "0 … 0.02 m in x"}},
        Spoiled{"boundary_too_fast",
                "[run]",
                with(kInlet + "velocity = [0.13, 0]"),
                {"boundary.velocity makes 0.13 m/s, 0.217 of C", "velocity_scale = 0.13"}},
        Spoiled{"start_too_fast",
                "[run]",
                with("[initial]\nkind = \"uniform\"\nvelocity = [0, 0.2]"),
                {"initial.velocity makes 0.2 m/s"}},
        Spoiled{"layers_too_fast",
                "[run]",
                with("[initial]\nkind = \"shear_layer\"\nvelocity = [0.12, 0]"),
                {"initial.velocity makes 0.1201 m/s", "0.2 of C"}},
        Spoiled{"point_outside",
                "fields_every = 0.05",
                "fields_every = 0.05\npoints = [[0.01, 0.07]]",
                {"output.points: [0.01, 0.07] lies outside the box", "0 … 0.06 m in y"}},
        Spoiled{"start_in_a_ball",
                "[run]",
                with("[[obstacle]]\ncentre = [0.01, 0.036]\ndiameter = 0.006"),
                {"particles.start: [0.01, 0.04]", "lies in the obstacle at [0.01, 0.036]"}},
        Spoiled{"start_in_a_block",
                "[run]",
                with("[[obstacle]]\nfrom = [0, 0.04]\nto = [0.02, 0.05]"),
                {"particles.start: [0.01, 0.04]", "lies in the obstacle at [0, 0.04]"}},
        Spoiled{"outflow_with_a_ramp",
                "[run]",
                with("[[boundary]]\nside = \"right\"\nkind = \"outflow\"\nramp = 1"),
                {"ramp", "has no meaning for an outflow", "pressure"}},
        Spoiled{"spin_too_fast",
                "[run]",
                with("[[obstacle]]\ncentre = [0.01, 0.02]\ndiameter = 0.01\nspin = 30"),
                {"spin makes 0.15 m/s"}}),
    [](const auto& info) { return info.param.name; });

/// Warnings of the settling disc with one text in place of another.
std::string warnings(const std::string& from, const std::string& to) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("scene.toml", test::replaced(test::good_scene(), from, to));
  std::string all;
  for (const std::string& w : make_plan(read_scene({file})).warnings) all += w + "\n";
  return all;
}

TEST(Scene, WhatWouldRunButNotAsItWasMeantIsWarnedOf) {
  const auto has = [](const std::string& text, const std::string& word) {
    return text.find(word) != std::string::npos;
  };
  EXPECT_EQ(warnings("[run]", with(kInlet + "velocity = [0.01, 0]\n[[boundary]]\nside = \"right\"\n"
                                            "kind = \"outflow\"")),
            "");
  EXPECT_EQ(warnings("[run]", with(kInlet + "velocity = [0, 0.01]")), "") << "along the wall";
  EXPECT_TRUE(has(warnings("[run]", with(kInlet + "velocity = [0.01, 0]")), "enters"));
  EXPECT_TRUE(has(warnings("[run]", with(kInlet + "velocity = [-0.01, 0]")), "leaves"));
  EXPECT_TRUE(has(warnings("[run]", with(kInlet + "velocity = [0.07, 0]")), "velocity_scale"));
  // The disc weighs 0.0120 N in the fluid: over 100 N/m, 0.0962 of 1.25 mm.
  EXPECT_TRUE(has(warnings("= 2.0e5", "= 100.0"), "0.0962 of its radius; 1.9e+02 N/m"));
  EXPECT_EQ(warnings("= 2.0e5", "= 200.0"), "");
  EXPECT_TRUE(has(warnings("end_time = 1.0", "end_time = 1000.0"), "2e+04 frames, 30.7 GB"));
  EXPECT_TRUE(
      has(warnings("kinematic_viscosity = 1e-5", "kinematic_viscosity = 10.0"), "unusually large"));
  EXPECT_EQ(warnings("kinematic_viscosity = 1e-5", "kinematic_viscosity = 0.01"), "");
  EXPECT_TRUE(
      has(warnings("gravity = [0.0, -9.8]", "gravity = [0.0, 9.8]"), "points upwards (+y)"));
  EXPECT_TRUE(has(warnings("gravity = [0.0, -9.8]", "gravity = [0.0, -9.8]\nbody_force = [0, 98]"),
                  "fluid.body_force = 98 m/s² can give 2 m/s, 33 times fluid.velocity_scale"));
  EXPECT_TRUE(has(warnings("sides_y = \"wall\"", "sides_y = \"periodic\""),
                  "gravity acts along y, where the box is periodic"));
  const auto obstacles = [](const std::string& list) { return warnings("[run]", with(list)); };
  const std::string ball = "[[obstacle]]\ncentre = [0.01, 0.02]\ndiameter = ";
  EXPECT_TRUE(has(obstacles(ball + "0.0003"), "[0.01, 0.02] is 2.4 cells wide"));
  EXPECT_EQ(obstacles(ball + "0.001"), "");
  EXPECT_TRUE(has(obstacles(ball + "0.004\n[[obstacle]]\ncentre = [0.012, 0.02]\ndiameter = 0.004"),
                  "the 2. obstacle overlaps the 1."));
  EXPECT_EQ(obstacles(ball + "0.004\n[[obstacle]]\ncentre = [0.014, 0.02]\ndiameter = 0.004"), "");
}

Scene settling_disc() {
  return read_scene({BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml"});
}
void expect_refused(const Scene& scene, const std::string& words) {
  try {
    make_plan(scene);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

TEST(Scene, AStepTooLongForTheViscosityIsRefused) {
  Scene scene = settling_disc();
  scene.fluid.viscosity = 1e-3;
  scene.numerics.time_step = 1e-4;  // tau = 0.5 + 3 · 1e-3 · 1e-4 / 1.25e-4² = 19.7
  expect_refused(scene, "τ = 19.7");
}

TEST(Scene, DiscsThatOverlapThroughAPeriodicSideAreRefused) {
  Scene scene = settling_disc();
  scene.particles->start = {{0.0005, 0.04, 0.0}, {0.0195, 0.04, 0.0}};
  expect_refused(scene, "outside the box");  // of walls
  scene.box.sides[0] = SideKind::Periodic;
  expect_refused(scene, "overlap by 0.0015 m");
  scene.particles->start[1].y() = 0.045;
  EXPECT_NO_THROW(make_plan(scene));
}

TEST(Scene, ALatticeLargerThanAnyMachineIsRefused) {
  try {
    const Populations f(lattice(VelocitySet::D3Q19), {20000, 20000, 20000}, Precision::Double);
    FAIL() << "allocated";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(" cells needs 1.22e+06 GB"), std::string::npos)
        << e.what();
  }
}

TEST(Scene, AMessageNamesAllFilesThatItMayMean) {
  const test::TemporaryFolder folder;
  const std::string scene = folder.write("scene.toml", test::good_scene()),
                    overlay = folder.write("overlay.toml", "[coupling]\nsubsteps = 1\n");
  expect_refused(read_scene({scene, overlay}), overlay + ": coupling.substeps = 1 makes");
}

TEST(Scene, MissingFileIsNamed) {
  try {
    read_scene({"nowhere/scene.toml"});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("nowhere/scene.toml: no such file"), std::string::npos);
  }
}

TEST(Scene, AParticleWiderThanHalfAPeriodicBoxIsRefused) {
  const test::TemporaryFolder folder;
  std::string text =
      test::replaced(test::good_scene(), "sides_x = \"wall\"", "sides_x = \"periodic\"");
  text = test::replaced(text, "size = [0.02, 0.06]", "size = [0.004, 0.06]");
  text = test::replaced(text, "[[0.01, 0.04]]", "[[0.002, 0.04]]");
  const Scene scene = read_scene({folder.write("scene.toml", text)});
  EXPECT_THROW(make_plan(scene), InputError);
}

TEST(Scene, OverlaysReplaceKeyByKeyAndKeepTheirFileInMessages) {
  const test::TemporaryFolder folder;
  const auto base = folder.write("scene.toml", test::good_scene());
  const auto over = folder.write("over.toml", "[numerics]\ncells_per_diameter = 10\n");
  const Scene scene = read_scene({base, over});
  EXPECT_EQ(scene.numerics.cells_per_diameter, 10.0);
  EXPECT_EQ(scene.numerics.collision, CollisionOperator::Trt);
  const auto bad = folder.write("bad.toml", "[fluid]\ndensity = -1\n");
  try {
    read_scene({base, bad});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("bad.toml:2"), std::string::npos) << e.what();
  }
}

}  // namespace
