// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/plan.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/coupling/report.h"
#include "lbm_solver/io/scene_reader.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

Scene settling_disc() {
  return read_scene({BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml"});
}

TEST(Plan, ChoosesTheStepByMach) {
  const Plan p = make_plan(settling_disc());
  EXPECT_EQ(p.domain.nx, 160);
  EXPECT_EQ(p.domain.ny, 480);
  EXPECT_NEAR(p.lattice_speed, 10 * 0.06, 1e-3);
  EXPECT_NE(p.step_limit.find("Mach"), std::string::npos);
  EXPECT_EQ(p.intervals, 4800);                      // 1.25e-4 m / 0.6 m/s, for a second
  EXPECT_NEAR(p.interval(), 1.0 / 4800.0, 1e-16);    // ends on time
  EXPECT_NEAR(p.kernel.parameters.tau, 0.9, 1e-12);  // ν = 1e-5 m²/s is 2/15 cells² a step
  EXPECT_EQ(p.substeps, 12);
}

TEST(Plan, ChoosesTheStepByRelaxationTimeWhereTheFluidIsViscous) {
  Scene s = settling_disc();
  s.fluid.viscosity = 1e-3;
  const Plan p = make_plan(s);
  EXPECT_NE(p.step_limit.find("relaxation"), std::string::npos);
  EXPECT_LE(p.kernel.parameters.tau, 1.5 + 1e-12);
  EXPECT_GT(p.kernel.parameters.tau, 1.49);
}

// A remedy that the binding limit would undo is none.
TEST(Plan, AdvisesByWhatBindsTheStep) {
  const auto refused = [](const Scene& s, const std::string& words) {
    try {
      make_plan(s);
      ADD_FAILURE() << "accepted where expected: " << words;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  Scene s = settling_disc();
  s.fluid.viscosity = 1e-13;
  refused(s, "a lower fluid.velocity_scale if nothing is that fast");
  s.numerics.time_step = 1e-4;
  refused(s, "a longer numerics.time_step");
  s = settling_disc();
  s.end_time = 1e10;
  refused(s, "or a smaller fluid.velocity_scale");
  s.fluid.viscosity = 1e-3;  // τ binds
  refused(s, "is the viscosity in m²/s?");
  s.numerics.time_step = 1e-4;  // where τ = 19
  refused(s, "is the viscosity in m²/s?");
  s.fluid.viscosity = 1e-7;
  s.fluid.velocity_scale = 1e-6;
  s.numerics.time_step = 1e-3;
  refused(s, "or a longer numerics.time_step");
}

TEST(Plan, WarnsWhereForcesGetNoisyAndWhereCellsAreFew) {
  Scene s = settling_disc();
  EXPECT_TRUE(make_plan(s).warnings.empty());
  s.fluid.viscosity = 1e-6;
  const auto noisy = make_plan(s).warnings;
  ASSERT_EQ(noisy.size(), 1U);
  EXPECT_NE(noisy[0].find("Re_h"), std::string::npos);
  s = settling_disc();
  s.numerics.cells_per_diameter = 2.5;
  const auto few = make_plan(s).warnings;
  for (const char* part : {"D/Δx", "2.5 cells a diameter the drag"})  // few, and what they cost
    EXPECT_TRUE(std::ranges::any_of(few, [part](const std::string& w) {
      return w.find(part) != std::string::npos;
    })) << part;
}

TEST(Plan, TellsTheErrorToExpectOfTheDrag) {
  Scene s = settling_disc();  // 20 cells a diameter: a fraction of a per cent
  EXPECT_NE(make_plan(s).expected_error.find("drag +0.0 % at a solid fraction of 0.00409 ["),
            std::string::npos)
      << make_plan(s).expected_error;
  s.particles->start.clear();  // how many the script brings, nobody knows
  EXPECT_NE(
      make_plan(s).expected_error.find(
          "drag -0.1 % at a solid fraction of 0.2, -1.7 % at a solid fraction of 0.5 [slow flow"),
      std::string::npos)
      << make_plan(s).expected_error;
  ObstacleScene post;  // beside them an obstacle, which is not all there will be
  post.round = true;
  post.diameter = s.particles->diameter.hi;
  s.obstacles.push_back(post);
  EXPECT_NE(make_plan(s).expected_error.find("at a solid fraction of 0.5"), std::string::npos)
      << make_plan(s).expected_error;
  s.obstacles.clear();
  s.numerics.cells_per_diameter = 5.0;
  const Plan coarse = make_plan(s);
  ASSERT_FALSE(coarse.warnings.empty());
  EXPECT_NE(coarse.warnings.front().find("% off at a solid fraction of 0.5"), std::string::npos)
      << coarse.warnings.front();
  const auto says = [&s](const std::string& words) {
    const Plan plan = make_plan(s);
    const std::string text =
        plan.expected_error + " | " + fmt::format("{}", fmt::join(plan.warnings, " | "));
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  s.particles->hydraulic_ratio = {
      0.5};  // the flow sees 2.5 cells, and packed discs as an array of 0.2
  says("with 2.5 cells a diameter the drag is more than");
  s.particles->hydraulic_ratio = {1.0};
  s.numerics.magic = 0.15;
  says("not tabulated for trt with layered_resistance and Λ = 0.15");
  s.numerics.magic.reset();
  s.numerics.collision = CollisionOperator::Bgk;
  s.numerics.solid_term = SolidTerm::Holdych;
  says("not tabulated for bgk with holdych");
  s.numerics.collision = CollisionOperator::CentralMoment;
  s.numerics.solid_term.reset();  // the table over τ, here 0.6
  says("drag -9.7 % at a solid fraction of 0.2 [");
}

// One Reynolds number, with its length, and the law with its own units.
TEST(Plan, NamesItsReynoldsNumberOnce) {
  Scene s = settling_disc();
  const auto lines_with_re = [&s] {
    const std::string text = describe(s, make_plan(s));
    std::string found;
    for (auto at = text.find("Re "); at != std::string::npos; at = text.find("Re ", at + 1))
      found += text.substr(at, 60) + "\n";
    return std::pair(found, text);
  };
  EXPECT_EQ(lines_with_re().first.find("Re = u L/ν 15 with L = 0.0025 m of the smallest particle"),
            0u)
      << lines_with_re().second;
  s.fluid.law = {
      .model = ViscosityScene::Model::Bingham, .consistency = 0.01, .yield_stress = 0.01};
  const auto [found, text] = lines_with_re();
  EXPECT_EQ(std::ranges::count(found, '\n'), 1) << found;
  EXPECT_NE(text.find("bingham, K 0.01 Pa s, σ_y"), std::string::npos) << text;
  EXPECT_NE(text.find("and a viscosity that depends on the shear rate: compare"),
            std::string::npos);
  s.fluid.law.model = ViscosityScene::Model::HerschelBulkley;
  EXPECT_NE(lines_with_re().second.find("K 0.01 Pa sⁿ, n 1"), std::string::npos);
}

TEST(Plan, SaysWhereATableOfErrorsEnds) {
  Scene s = read_scene({BPLBM_SOURCE_DIR "/cases/cylinder_array/scene.toml"});
  s.obstacles[0].diameter = 0.9 * s.box.size.x();  // c = 0.64
  const Plan plan = make_plan(s);
  EXPECT_NE(plan.expected_error.find("drag more than"), std::string::npos) << plan.expected_error;
  EXPECT_TRUE(std::ranges::any_of(plan.warnings, [](const std::string& w) {
    return w.find("more than") != std::string::npos;
  }));
}

TEST(Plan, AutoTakesTheOperatorThatSuitsAndSaysWhy) {
  Scene s = settling_disc();
  s.numerics.collision.reset();
  s.numerics.solid_term.reset();
  Plan p = make_plan(s);
  EXPECT_EQ(p.kernel.collision, CollisionOperator::Trt);
  EXPECT_EQ(p.kernel.solid_term, SolidTerm::LayeredResistance);
  s.fluid.viscosity = 1e-6;  // Re_h = 7.5
  p = make_plan(s);
  EXPECT_EQ(p.kernel.collision, CollisionOperator::CentralMoment);
  EXPECT_EQ(p.kernel.solid_term, SolidTerm::LayeredNobleTorczynski);
  EXPECT_NE(p.collision_reason.find("Re_h = 7.5"), std::string::npos) << p.collision_reason;
  s.fluid.viscosity = 1e-5;
  s.numerics.smagorinsky = 0.1;
  EXPECT_EQ(make_plan(s).kernel.collision, CollisionOperator::CentralMoment);
  s.numerics.collision = CollisionOperator::Trt;
  EXPECT_NE(make_plan(s).warnings.back().find("turbulence"), std::string::npos);
}

TEST(Plan, ReportSaysWhatTheHydraulicRatioDoes) {
  Scene s = settling_disc();
  EXPECT_EQ(describe(s, make_plan(s)).find("hydraulic"), std::string::npos);
  s.particles->hydraulic_ratio = {0.8};
  const std::string one = describe(s, make_plan(s));
  EXPECT_NE(one.find("ratio 0.8: the flow sees discs of D 0.002 … 0.002 m, D/Δx 16;"),
            std::string::npos)
      << one;
  EXPECT_NE(one.find("buoyancy and contacts are those of the whole discs"), std::string::npos);
  s.particles->hydraulic_ratio = {1.0, 0.8};
  EXPECT_NE(describe(s, make_plan(s)).find("ratio 1, 0.8 by type:"), std::string::npos);
}

TEST(Plan, HandshakeOffersEveryNumberTheScriptNeeds) {
  const Scene s = settling_disc();
  const Plan p = make_plan(s);
  const auto hello = make_handshake(s, p);
  const auto value = [&](const std::string& name) -> std::string {
    for (const auto& v : hello.variables)
      if (v.name == name) return v.value;
    return "absent";
  };
  EXPECT_EQ(std::stod(value("solid_step")), p.interval() / p.substeps);  // text keeps every bit
  EXPECT_EQ(value("x_hi"), "0.02");
  EXPECT_EQ(value("boundary_y"), "f");
  EXPECT_EQ(value("particle1_y"), "0.04");
  EXPECT_EQ(value("damping_ratio"), "0.5");
  EXPECT_EQ(value("solid_steps_total"), std::to_string(p.intervals * p.substeps));
}

}  // namespace
