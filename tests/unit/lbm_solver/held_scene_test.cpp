// SPDX-License-Identifier: GPL-2.0-or-later
/// Flows that are held, velocities along a side and the viscosity among the fields, as a scene
/// gives them: what is refused, and what becomes of the rest.
#include <gtest/gtest.h>

#include <fmt/ranges.h>

#include <cmath>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/plan.h"
#include "lbm_solver/solver/viscosity_use.h"
#include "lbm_solver/viscosity/viscosity_law.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

std::string slot(const std::string& fluid, const std::string& rest = "",
                 const std::string& sides = "sides_x = \"periodic\"") {
  return "[box]\nsize = [0.02, 0.01]\n" + sides +
         "\n[fluid]\ndensity = 1000.0\nvelocity_scale = 0.02\n" + fluid +
         "\n[numerics]\ncell = 0.0005\n[run]\nend_time = 0.1\n" + rest;
}
const std::string kWater = "kinematic_viscosity = 1e-5\n";

std::string inlet(const std::string& keys) {
  return "[[boundary]]\nside = \"left\"\nkind = \"velocity\"\nvelocity = [0.01, 0.0]\n" + keys +
         "\n[[boundary]]\nside = \"right\"\nkind = \"pressure\"\n";
}

/// A pressure boundary on a side.
std::string opening(const std::string& side, const std::string& keys = "",
                    const std::string& kind = "pressure") {
  return "[[boundary]]\nside = \"" + side + "\"\nkind = \"" + kind + "\"\n" + keys + "\n";
}

struct Refused {
  std::string name, scene;
  std::vector<std::string> words;
};
void PrintTo(const Refused& r, std::ostream* out) {
  *out << r.name;
}

class BadDrive : public testing::TestWithParam<Refused> {};

TEST_P(BadDrive, IsNamedWithReasonAndRemedy) {
  const test::TemporaryFolder folder;
  folder.write("words.csv", "y,factor\n0,one\n");
  folder.write("twice.csv", "y,factor\n0,1\n0,2\n");
  folder.write("one.csv", "y,factor\n0,1\n");
  folder.write("gaps.csv", "y,z,factor\n0,0,1\n0.01,0,1\n0.01,0.01,1\n");
  folder.write("two.csv", "y,factor\n0,1\n0.01,0\n");
  folder.write("across.csv", "x,factor\n0,1\n1,1\n");
  try {
    make_plan(read_scene({folder.write("scene.toml", GetParam().scene)}));
    FAIL() << "accepted";
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("; "), std::string::npos) << "no remedy in: " << text;
    for (const auto& word : GetParam().words) EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

const std::string kWalls = "sides_x = \"wall\"";

INSTANTIATE_TEST_SUITE_P(
    All, BadDrive,
    testing::Values(
        Refused{"flow_across_walls",
                slot(kWater + "flow_rate = 1e-4\nflow_axis = \"y\"\n"),
                {"fluid.flow_rate", "sides_y are walls: nothing can flow there", "periodic"}},
        Refused{"flow_and_force",
                slot(kWater + "flow_rate = 1e-4\nbody_force = [1.0, 0.0]\n"),
                {"fluid.flow_rate", "fluid.body_force", "and finds the force itself", "leave one"}},
        Refused{"flow_and_jump",
                slot(kWater + "flow_rate = 1e-4\n", "",
                     "sides_x = \"periodic\"\npressure_jump = [1.0, 0.0]"),
                {"fluid.flow_rate", "box.pressure_jump", "leave one"}},
        Refused{"ramp_of_no_flow", slot(kWater + "flow_ramp = 1.0\n"), {"flow_ramp", "flow_rate"}},
        Refused{"flow_too_fast",
                slot(kWater + "flow_rate = 0.1\n"),
                {"fluid.flow_rate", "velocity_scale"}},
        Refused{
            "flow_through_two_openings",
            slot(kWater, opening("left", "flow_rate = 1e-4") + opening("right", "flow_rate = 1e-4"),
                 kWalls),
            {"boundary.flow_rate", "one pressure is found at a time", "give the others"}},
        Refused{"flow_that_gets_out_nowhere",
                slot(kWater, opening("left", "flow_rate = 1e-4"), kWalls),
                {"boundary.flow_rate", "no other opening", "add a boundary"}},
        Refused{
            "flow_through_an_outflow",
            slot(kWater, opening("left", "flow_rate = 1e-4", "outflow") + opening("right"), kWalls),
            {"flow_rate", "no meaning for an outflow", "pressure"}},
        Refused{"flow_of_two_kinds",
                slot(kWater + "flow_rate = 1e-4\nflow_axis = \"y\"\n",
                     opening("left", "flow_rate = 1e-4") + opening("right"),
                     "sides_x = \"wall\"\nsides_y = \"periodic\""),
                {"boundary.flow_rate", "fluid.flow_rate", "leave one"}},
        Refused{"flow_through_an_opening_too_fast",
                slot(kWater, opening("left", "flow_rate = 0.1") + opening("right"), kWalls),
                {"boundary.flow_rate", "velocity_scale"}},
        Refused{"profile_absent",
                slot(kWater, inlet("profile_table = \"none.csv\""), kWalls),
                {"profile_table", "none.csv", "beside the scene"}},
        Refused{"profile_of_words",
                slot(kWater, inlet("profile_table = \"words.csv\""), kWalls),
                {"line 2", "2 finite numbers"}},
        Refused{"profile_of_one_place_twice",
                slot(kWater, inlet("profile_table = \"twice.csv\""), kWalls),
                {"line 3", "place of an earlier line"}},
        Refused{"profile_of_one_place",
                slot(kWater, inlet("profile_table = \"one.csv\""), kWalls),
                {"fewer than two places"}},
        Refused{"profile_with_gaps",
                "[box]\nsize = [0.02, 0.01, 0.01]\n[fluid]\ndensity = 1000.0\nvelocity_scale = "
                "0.02\nkinematic_viscosity = 1e-5\n[numerics]\ncell = 0.001\n[run]\nend_time = "
                "0.1\n[[boundary]]\nside = \"left\"\nkind = \"velocity\"\nvelocity = [0.01, 0.0, "
                "0.0]\nprofile_table = \"gaps.csv\"\n",
                {"3 lines, and 2 × 2 places along its axes", "every place"}},
        Refused{"profile_of_another_axis",
                slot(kWater, inlet("profile_table = \"across.csv\""), kWalls),
                {"begins with 'x,factor'", "y,factor"}},
        Refused{"profile_and_parabola",
                slot(kWater, inlet("profile = \"parabolic\"\nprofile_table = \"two.csv\""), kWalls),
                {"profile_table", "stands beside", "parabolic"}}),
    [](const auto& info) { return info.param.name; });

// 1e-4 m³/s through an opening of 0.01 m and a depth of 1 m: 0.01 m/s.
TEST(HeldOpening, FlowIsThatOfTheScene) {
  const test::TemporaryFolder folder;
  const Scene scene = read_scene({folder.write(
      "scene.toml", slot(kWater, opening("left", "flow_rate = 1e-4") + opening("right"), kWalls))});
  const Plan plan = make_plan(scene);
  Fluid fluid = make_fluid(scene, plan, Decomposition(plan.domain));
  ASSERT_TRUE(fluid.pressure_control());
  EXPECT_NEAR(fluid.pressure_control()->wanted(0) / (20.0 * 0.01 / plan.units.velocity()), 1.0,
              1e-9);
  fluid.advance(20000);
  EXPECT_NEAR(fluid.pressure_control()->flow() / fluid.pressure_control()->wanted(0), 1.0, 1e-3);
}

// The control's time is 8·40·√3 steps of 2.5 ms, 1.39 s.
TEST(HeldOpening, SaysHowFarItFollowsAnOscillation) {
  const test::TemporaryFolder folder;
  folder.write("tide.csv", "time,factor\n0,0\n1,1\n1.94,0\n");
  const auto said = [&](const std::string& keys) {
    const std::string text =
        slot(kWater, opening("left", "flow_rate = 1e-4\n" + keys) + opening("right"), kWalls);
    return fmt::format(
        "{}", fmt::join(make_plan(read_scene({folder.write("scene.toml", text)})).warnings, "\n"));
  };
  EXPECT_EQ(said(""), "");
  const auto has = [&](const std::string& keys, const std::string& words) {
    return said(keys).find(words) != std::string::npos;
  };
  EXPECT_TRUE(
      has("frequency = 0.515", "with a period of 1.94 s some 51 % comes, 0.15 of a period late"))
      << said("frequency = 0.515");
  EXPECT_TRUE(
      has("table = \"tide.csv\"\nrepeat = \"periodic\"", "some 51 % comes, 0.15 of a period late"));
  EXPECT_FALSE(has("frequency = 0.003", "comes"));
  // of a table what swings most counts: twice in its span here, repeated or not
  folder.write("twice.csv", "time,factor\n0,0\n0.97,1\n1.94,0\n2.91,1\n3.88,0\n");
  for (const std::string repeat : {"periodic", "once"})
    EXPECT_TRUE(has("table = \"twice.csv\"\nrepeat = \"" + repeat + "\"",
                    "with a period of 1.94 s some 51 % comes"))
        << repeat << said("table = \"twice.csv\"\nrepeat = \"" + repeat + "\"");
  folder.write("ramp.csv", "time,factor\n0,0\n1,1\n");
  EXPECT_FALSE(has("table = \"ramp.csv\"\nrepeat = \"once\"", "comes"));
}

TEST(HeldFlow, WarnsWhereRoundOffShowsInTheForce) {
  const test::TemporaryFolder folder;
  const auto said = [&](const std::string& rate) {
    const Scene s =
        read_scene({folder.write("scene.toml", slot(kWater + "flow_rate = " + rate + "\n"))});
    return fmt::format("{}", fmt::join(make_plan(s).warnings, "\n"));
  };
  EXPECT_NE(said("1e-17").find("of the force that is found for it"), std::string::npos);
  EXPECT_EQ(said("1e-12"), "");
}

/// The number behind some words of a text; 0: they are not there.
double number_after(const std::string& text, const std::string& words) {
  const auto at = text.find(words);
  return at == std::string::npos ? 0.0 : std::stod(text.substr(at + words.size()));
}

// What the message advises ends it, whether Mach's number binds the step, or τ; where nothing can
// be done, the force itself.
TEST(HeldFlow, AdvisesAgainstRoundOffWhatCanBeDone) {
  const test::TemporaryFolder folder;
  const auto said = [&](const Scene& s) {
    return fmt::format("{}", fmt::join(make_plan(s).warnings, "\n"));
  };
  const auto scene = [&](const std::string& viscosity, const std::string& rate) {
    return read_scene({folder.write("scene.toml", slot("kinematic_viscosity = " + viscosity +
                                                       "\nflow_rate = " + rate + "\n"))});
  };
  Scene fast = scene("1e-6", "1e-15");
  const double step = number_after(said(fast), "take fluid.velocity_scale = ");
  ASSERT_GT(step, 0.0) << said(fast);
  fast.fluid.velocity_scale = step;
  EXPECT_EQ(said(fast), "");
  Scene thick = scene("1e-2", "1e-15");  // τ binds
  const double cell = number_after(said(thick), "take cells of ");
  ASSERT_GT(cell, 0.0) << said(thick);
  thick.numerics.cell = 0.00125;
  EXPECT_LE(cell, 0.00125);
  EXPECT_EQ(said(thick), "");
  Scene given = scene("1e-6", "4e-15");
  given.numerics.time_step = 1e-3;
  given.numerics.time_step = number_after(said(given), "take numerics.time_step = ");
  EXPECT_EQ(said(given), "");
  given.numerics.time_step = 2.5e-3;  // as long as velocity_scale lets it be
  given.fluid.flow->rate = 1e-15;
  const double larger = number_after(said(given), "take cells of ");
  ASSERT_GT(larger, 0.0) << said(given);
  EXPECT_LE(larger, 0.00125);
  given.numerics.time_step = 2.5e-3 * 0.00125 / 0.0005;
  given.numerics.cell = 0.00125;
  EXPECT_EQ(said(given), "");
  EXPECT_NE(said(scene("1e-2", "1e-22")).find("give fluid.body_force in its place, 1.2e-17 m/s²"),
            std::string::npos)
      << said(scene("1e-2", "1e-22"));
}

// A parabola from a table of 81 lines, against the one that a scene can name: chords are lower by
// 4 (1/80)²/4 of the middle.
TEST(SideProfile, FromATableIsTheParabola) {
  const test::TemporaryFolder folder;
  std::string table = "y,factor\n";
  for (int i = 80; i >= 0; --i) {  // lines come in any order
    const double s = i / 80.0;
    table += std::to_string(0.01 * s) + "," + std::to_string(4.0 * s * (1.0 - s)) + "\n";
  }
  folder.write("inlet.csv", table);
  const auto fluid_of = [&](const std::string& keys) {
    const Scene scene = read_scene({folder.write("scene.toml", slot(kWater, inlet(keys), kWalls))});
    const Plan plan = make_plan(scene);
    EXPECT_TRUE(plan.warnings.empty()) << plan.warnings.front();
    Fluid fluid = make_fluid(scene, plan, Decomposition(plan.domain));
    fluid.advance(200);
    return fluid;
  };
  const Fluid named = fluid_of("profile = \"parabolic\""),
              read = fluid_of("profile_table = \"inlet.csv\"");
  const double middle = named.cell(1, 10).u.x();
  EXPECT_GT(middle, 0.0);
  for (int y = 0; y < 20; ++y)
    EXPECT_NEAR(read.cell(1, y).u.x(), named.cell(1, y).u.x(), 5e-4 * middle) << y;
}

TEST(SideProfile, LiesOnAGridOfTwoAxes) {
  const SideProfile profile{{{{0.0, 2.0}, {1.0, 3.0, 4.0}}}, {1.0, 3.0, 5.0, 7.0, 0.0, 0.0}};
  EXPECT_DOUBLE_EQ(profile.factor({0.0, 1.0}), 1.0);
  EXPECT_DOUBLE_EQ(profile.factor({2.0, 3.0}), 7.0);
  EXPECT_DOUBLE_EQ(profile.factor({1.0, 2.0}), 4.0);
  EXPECT_DOUBLE_EQ(profile.factor({-5.0, 9.0}), 0.0);
  EXPECT_DOUBLE_EQ(profile.factor({0.5, 0.0}), 1.5);
  const SideProfile second{{{{}, {0.0, 10.0}}}, {0.0, 1.0}};
  EXPECT_DOUBLE_EQ(second.factor({7.0, 2.5}), 0.25);
}

// What the fields show is what cells collide with: in uniform shear the law at its rate.
TEST(ShownViscosity, IsThatOfTheLaw) {
  const test::TemporaryFolder folder;
  const std::string plates =
      "[[boundary]]\nside = \"top\"\nkind = \"moving_wall\"\nvelocity = [0.01, 0.0]\n"
      "[output]\nviscosity = true\n";
  const Scene scene = read_scene({folder.write(
      "scene.toml", slot("viscosity = {model = \"power_law\", consistency = 0.5, index = 0.5, "
                         "shear_rate = 1.0}\n",
                         plates))});
  EXPECT_TRUE(scene.output.viscosity);
  const Plan plan = make_plan(scene);
  Fluid fluid = make_fluid(scene, plan, Decomposition(plan.domain));
  fluid.advance(4000);
  std::vector<double> nu(static_cast<std::size_t>(plan.domain.nx));
  const double unit = plan.units.dx * plan.units.dx / plan.units.dt;
  for (int y = 0; y < plan.domain.ny; ++y) {
    row_viscosity(fluid, plan.kernel.parameters, y, 0, nu);
    EXPECT_NEAR(nu[3] * unit / 5e-4, 1.0, 0.005) << y;  // (K/ρ) γ̇^(n-1) at 1/s
  }
}

// A fluid that thickens: its stress, which is linear between the walls, brings the ten outer rows
// of twenty to nu_max, and leaves the two in the middle at nu_min. The bounds are so near each
// other that they share most of the table. An eddy viscosity on top (a thousandth here) moves
// nothing.
TEST(ViscosityUse, CountsTheFluidAtBothBounds) {
  const test::TemporaryFolder folder;
  for (const char* eddies : {"", ", smagorinsky = 0.1"}) {
    const Scene scene = read_scene({folder.write(
        "scene.toml",
        slot(std::string("body_force = [0.16, 0.0]\nviscosity = {model = \"power_law\", "
                         "consistency = 0.05, index = 1.5, nu_min = 0.667e-4, nu_max "
                         "= 1e-4") +
             eddies + "}\n"))});
    const Plan plan = make_plan(scene);
    Fluid fluid = make_fluid(scene, plan, Decomposition(plan.domain));
    fluid.advance(4000);
    const ViscosityUse use = viscosity_use(fluid, plan.kernel.parameters);
    EXPECT_NEAR(use.at_shear_bound, 0.5, 1e-9) << eddies;
    EXPECT_NEAR(use.at_rest_bound, 0.1, 1e-9) << eddies;
  }
}

}  // namespace
