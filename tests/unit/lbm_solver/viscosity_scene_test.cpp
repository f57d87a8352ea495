// SPDX-License-Identifier: GPL-2.0-or-later
/// Laws of viscosity and drives in time as a scene gives them: what is refused, and what the plan
/// makes of the rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/creep.h"
#include "lbm_solver/solver/viscosity_plan.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "lbm_solver/viscosity/viscosity_law.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

/// A slot 1 cm wide, with more keys of [fluid].
std::string slot(const std::string& fluid, const std::string& rest = "") {
  return "[box]\nsize = [0.02, 0.01]\nsides_x = \"periodic\"\n[fluid]\ndensity = 1000.0\n"
         "velocity_scale = 0.02\nbody_force = [2.0, 0.0]\n" +
         fluid + "\n[numerics]\ncell = 0.0005\n[run]\nend_time = 0.1\n" + rest;
}

const std::string kGel = "viscosity = {model = \"power_law\", consistency = 0.5, index = 0.5";

struct Refused {
  std::string name, fluid;
  std::vector<std::string> words;
};
void PrintTo(const Refused& r, std::ostream* out) {
  *out << r.name;
}

class BadFluid : public testing::TestWithParam<Refused> {};

TEST_P(BadFluid, IsNamedWithReasonAndRemedy) {
  const test::TemporaryFolder folder;
  folder.write("falls.csv", "time,factor\n0,1\n2,0\n1,1\n");
  folder.write("open.csv", "time,factor\n0,1\n1,0.5\n");
  folder.write("words.csv", "time,factor\n0,one\n");
  try {
    make_plan(read_scene({folder.write("scene.toml", slot(GetParam().fluid))}));
    FAIL() << "accepted";
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("; "), std::string::npos) << "no remedy in: " << text;
    for (const auto& word : GetParam().words) EXPECT_NE(text.find(word), std::string::npos) << text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BadFluid,
    testing::Values(
        Refused{"both_viscosities",
                "kinematic_viscosity = 1e-6\n" + kGel + "}",
                {"kinematic_viscosity", "power_law", "leave it out"}},
        Refused{"no_consistency",
                "viscosity = {model = \"power_law\", index = 0.5}",
                {"fluid.viscosity.consistency", "missing"}},
        Refused{"foreign_key",
                kGel + ", yield_stress = 1}",
                {"yield_stress", "no meaning", "power_law"}},
        Refused{
            "unknown_model", "viscosity = {model = \"treacle\"}", {"treacle", "herschel_bulkley"}},
        Refused{"index_of_nothing",
                "viscosity = {model = \"power_law\", consistency = 1, index = 0}",
                {"index"}},
        Refused{"bounds_crossed",
                kGel + ", nu_min = 1e-3, nu_max = 1e-4}",
                {"nu_min", "not below nu_max"}},
        Refused{"carreau_without_bounds",
                "viscosity = {model = \"carreau\", index = 0.5, time_constant = 1, nu_max = 1}",
                {"nu_min", "missing"}},
        Refused{"carreau_that_thickens",
                "viscosity = {model = \"carreau\", index = 1.2, time_constant = 1, nu_min = 1e-6, "
                "nu_max = 1e-4}",
                {"index", "does not thin", "what thickens is a power_law"}},
        Refused{"carreau_that_is_newtonian",
                "viscosity = {model = \"carreau\", index = 1.0, time_constant = 1, nu_min = 1e-6, "
                "nu_max = 1e-4}",
                {"index", "does not thin", "newtonian"}},
        Refused{"yield_stress_of_rock",
                "viscosity = {model = \"bingham\", consistency = 0.1, yield_stress = 1e6}",
                {"yield_stress = 1e+06 Pa", "times the viscous stress", "is it in Pa?"}},
        Refused{"yield_stress_that_takes_for_ever",
                "viscosity = {model = \"bingham\", consistency = 1e4, yield_stress = 1e11}",
                {"run.end_time", "needs", "yield_stress = 1e+11 Pa", "is it in Pa?"}},
        Refused{"too_stiff", kGel + ", nu_max = 10.0}", {"nu_max", "τ", "take at most"}},
        Refused{"smagorinsky_without_its_constant",
                "kinematic_viscosity = 1e-6\nviscosity = {model = \"smagorinsky\"}",
                {"smagorinsky", "0.1"}},
        Refused{"table_absent",
                "kinematic_viscosity = 1e-4\nbody_force_table = \"none.csv\"",
                {"body_force_table", "none.csv"}},
        Refused{"table_unsorted",
                "kinematic_viscosity = 1e-4\nbody_force_table = \"falls.csv\"",
                {"line 4", "does not come after"}},
        Refused{"table_of_words",
                "kinematic_viscosity = 1e-4\nbody_force_table = \"words.csv\"",
                {"line 2", "two finite numbers"}},
        Refused{"table_does_not_close",
                "kinematic_viscosity = 1e-4\nbody_force_table = \"open.csv\"\nbody_force_repeat = "
                "\"periodic\"",
                {"open.csv", "last factor is not its first"}},
        Refused{"repeat_of_nothing",
                "kinematic_viscosity = 1e-4\nbody_force_repeat = \"periodic\"",
                {"body_force_table", "missing"}},
        Refused{"too_fast",
                "kinematic_viscosity = 1e-4\nbody_force_frequency = 1e5",
                {"body_force_frequency", "steps a period"}}),
    [](const auto& info) { return info.param.name; });

Scene scene_with(const test::TemporaryFolder& folder, const std::string& fluid) {
  return read_scene({folder.write("scene.toml", slot(fluid))});
}

// K/rho γ̇^(n-1) at velocity_scale over the half-width, 4/s: 5e-4/2 m²/s.
TEST(ViscosityOfAScene, IsThatAtTheTypicalShearRate) {
  const test::TemporaryFolder folder;
  const Scene s = scene_with(folder, kGel + "}");
  EXPECT_NEAR(s.fluid.viscosity, 2.5e-4, 1e-12);
  const Plan plan = make_plan(s);
  EXPECT_NEAR(plan.kernel.parameters.tau, 0.5 + 3.0 * 2.5e-4 * plan.units.dt / 2.5e-7, 1e-9);
  ASSERT_TRUE(plan.kernel.parameters.viscosity_table);
  EXPECT_EQ(plan.kernel.collision, CollisionOperator::Trt);
  EXPECT_EQ(describe_viscosity(s, plan).size(), 4u);
}

/// Whether a plan warns in these words.
bool warns(const Plan& plan, const std::string& words) {
  return std::ranges::any_of(
      plan.warnings, [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

TEST(ViscosityOfAScene, SaysWhichDefaultsItTook) {
  const test::TemporaryFolder folder;
  const auto last_line = [&](const std::string& law) {
    const Scene s = scene_with(folder, law);
    return describe_viscosity(s, make_plan(s)).back();
  };
  EXPECT_EQ(last_line(kGel + "}"),
            "by default shear_rate 4 1/s (velocity_scale over 0.005 m), nu_min 2.5e-06 m²/s (a "
            "hundredth of the typical one), nu_max 0.025 m²/s (a hundred times the typical one)");
  EXPECT_EQ(last_line(kGel + ", shear_rate = 5.0, nu_max = 1e-2}"),
            "by default nu_min 2.236e-06 m²/s (a hundredth of the typical one)");
  const std::string all = last_line(kGel + ", shear_rate = 5.0, nu_min = 1e-6, nu_max = 1e-2}");
  EXPECT_EQ(all.find("by default"), std::string::npos) << all;
  // a bound of a message, too
  Scene s = scene_with(folder, kGel + "}");
  s.numerics.time_step = 4e-4;
  EXPECT_TRUE(
      warns(make_plan(s), "nu_max = 0.025 m²/s (default: a hundred times the typical one)"));
}

// At 1000 times the viscous stress a hundredth of the viscosity would be ten times K/ρ.
TEST(ViscosityOfAScene, ABinghamFluidComesDownToItsPlasticViscosity) {
  const test::TemporaryFolder folder;
  const std::string mud = "viscosity = {model = \"bingham\", consistency = 0.01, yield_stress = 40";
  const Scene s = scene_with(folder, mud + "}");
  EXPECT_DOUBLE_EQ(ViscosityLaw(s.fluid, 4.0).nu_min(), 1e-5);
  const Plan plan = make_plan(s);
  EXPECT_NE(describe_viscosity(s, plan).back().find("nu_min 1e-05 m²/s (K/ρ)"), std::string::npos);
  EXPECT_FALSE(warns(plan, "thicker than its law"));
  EXPECT_TRUE(warns(make_plan(scene_with(folder, mud + ", nu_min = 1e-4}")),
                    "where it flows it is thicker than its law"));
  // no bound of its own where the viscosity goes on falling
  const std::string paste =
      "viscosity = {model = \"herschel_bulkley\", consistency = 0.01, index = 0.5, yield_stress = ";
  EXPECT_TRUE(warns(make_plan(scene_with(folder, paste + "10}")), "thicker than its law"));
  EXPECT_FALSE(warns(make_plan(scene_with(folder, paste + "1}")), "thicker than its law"));
}

// By an independent sum over the stress: below the crossing the fluid is sheared with σ/nu_max.
TEST(ViscosityOfAScene, KnowsWhatCreepAddsToAChannel) {
  for (const double n : {1.0, 0.5}) {
    constexpr double wall_rate = 3.0, yield = 0.5, density = 1000.0;  // stress at the walls: 1 Pa
    FluidScene mud{.density = density};
    mud.law = {.model = ViscosityScene::Model::HerschelBulkley,
               .consistency = 0.5 / std::pow(wall_rate, n),
               .index = n,
               .yield_stress = yield,
               .nu_min = 1e-9,
               .nu_max = 100.0 / (wall_rate * density)};
    double exact = 0.0, bounded = 0.0;
    constexpr int parts = 200000;
    for (int i = 0; i < parts; ++i) {
      const double stress = (i + 0.5) / parts;
      const double rate =
          wall_rate * std::pow(std::max(0.0, (stress - yield) / (1.0 - yield)), 1.0 / n);
      exact += stress * rate;
      bounded += stress * std::max(rate, stress * wall_rate / 100.0);
    }
    EXPECT_NEAR(creep_in_channel(mud, ViscosityLaw(mud, wall_rate), wall_rate),
                bounded / exact - 1.0, 1e-5)
        << n;
    EXPECT_NEAR(bounded / exact - 1.0, n == 1.0 ? 0.0020 : 0.0033, 1e-4);
    EXPECT_NEAR(plug_in_channel(mud, wall_rate), 0.5, 1e-12);
  }
}

// ν goes with the square root of the shear rate, so bounds a hundredth and a hundred times the
// typical one lie at 1e-4 and 1e4 times the typical rate.
TEST(ViscosityOfAScene, SaysWhereALawThatThickensActs) {
  const test::TemporaryFolder folder;
  const Scene s =
      scene_with(folder, "viscosity = {model = \"power_law\", consistency = 0.01, index = 1.5}");
  double from = 0.0, to = 0.0;
  for (const std::string& line : describe_viscosity(s, make_plan(s))) {
    const auto at = line.find("acts from");
    if (at == std::string::npos) continue;
    EXPECT_EQ(std::sscanf(line.c_str() + at, "acts from %lf to %lf", &from, &to), 2) << line;
  }
  EXPECT_NEAR(from / typical_shear_rate(s), 1e-4, 2e-6);  // it is looked for in steps of 1 %
  EXPECT_NEAR(to / typical_shear_rate(s), 1e4, 2e2);
}

// ρ G H/2 = 10 Pa at the walls of the slot.
TEST(ViscosityOfAScene, WarnsOfAYieldStressThatNothingOvercomes) {
  const test::TemporaryFolder folder;
  const auto held = [&](const std::string& yield, const std::string& rest = "") {
    const std::string law =
        "viscosity = {model = \"bingham\", consistency = 1.0, yield_stress = " + yield + "}";
    const Scene s = read_scene({folder.write("scene.toml", slot(law, rest))});
    return warns(make_plan(s), "holds everything");
  };
  EXPECT_TRUE(held("10.1"));
  EXPECT_FALSE(held("9.9"));
  const std::string top = "[[boundary]]\nside = \"top\"\nkind = ";
  EXPECT_FALSE(held("10.1", top + "\"moving_wall\"\nvelocity = [0.01, 0.0]\n"));
}

// Around discs of a periodic box it is at most their capacity, (4√2 + 2π) σ_y D, and the shear
// between two rows of them, ρ G H/2; a drop of pressure along walls Δp H/(2 L); a disc's weight
// against the same capacity.
TEST(ViscosityOfAScene, KnowsWhatDiscsPressuresAndWeightsOvercome) {
  const test::TemporaryFolder folder;
  const auto held = [&](double yield, const std::string& box, const std::string& force,
                        const std::string& rest) {
    const std::string law = "viscosity = {model = \"bingham\", consistency = 1.0, yield_stress = " +
                            std::to_string(yield) + "}\n";
    const Scene s = read_scene({folder.write(
        "scene.toml", "[box]\nsize = [0.02, 0.01]\n" + box + "[fluid]\ndensity = 1000.0\n" + force +
                          "velocity_scale = 0.02\n" + law + "[numerics]\ncell = 0.0005\n" +
                          "[run]\nend_time = 0.1\n" + rest)});
    return warns(make_plan(s), "holds everything");
  };
  const auto at_limit = [&](double limit, const std::string& box, const std::string& force,
                            const std::string& rest) {
    return held(1.01 * limit, box, force, rest) && !held(0.99 * limit, box, force, rest);
  };
  const double disc = 4.0 * std::sqrt(2.0) + 2.0 * std::numbers::pi;
  EXPECT_TRUE(at_limit(2000.0 * (2e-4 / (disc * 0.004) + 0.5 * 0.01),
                       "sides_x = \"periodic\"\nsides_y = \"periodic\"\n",
                       "body_force = [2.0, 0.0]\n",
                       "[[obstacle]]\ncentre = [0.01, 0.005]\ndiameter = 0.004\n"));
  EXPECT_TRUE(at_limit(8.0 * 0.01 / (2.0 * 0.02), "", "",
                       "[[boundary]]\nside = \"left\"\nkind = \"pressure\"\npressure = 8.0\n"
                       "[[boundary]]\nside = \"right\"\nkind = \"pressure\"\n"));
  EXPECT_TRUE(at_limit(500.0 * 9.81 * std::numbers::pi / 4.0 * 0.002 / disc, "",
                       "gravity = [0.0, -9.81]\n",
                       "[particles]\ndiameter = 0.002\ndensity = 1500.0\n[coupling]\n"));
}

// Its formula is Newtonian.
TEST(ViscosityOfAScene, RefusesLubrication) {
  const test::TemporaryFolder folder;
  const auto why = [&](const std::string& fluid) -> std::string {
    const std::string grains =
        "[particles]\ndiameter = 0.002\ndensity = 1500.0\n[coupling]\nlubrication_range = 0.5\n";
    try {
      make_plan(read_scene({folder.write("scene.toml", slot(fluid, grains))}));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const std::string refusal = why(kGel + "}");
  EXPECT_NE(refusal.find("coupling.lubrication_range: is a Newtonian law"), std::string::npos)
      << refusal;
  EXPECT_EQ(why("kinematic_viscosity = 1e-4"), "");
}

TEST(ViscosityOfAScene, NewtonianOnesHaveNoTable) {
  const test::TemporaryFolder folder;
  const Scene plain = scene_with(folder, "kinematic_viscosity = 1e-4");
  EXPECT_FALSE(make_plan(plain).kernel.local_viscosity());
  const Scene les = scene_with(
      folder,
      "kinematic_viscosity = 1e-4\nviscosity = {model = \"smagorinsky\", smagorinsky = 0.1}");
  EXPECT_FALSE(make_plan(les).kernel.parameters.viscosity_table);
  EXPECT_EQ(make_plan(les).kernel.parameters.smagorinsky, 0.1);
}

// Both at once: the eddy viscosity (S_c h)² γ̇ on top of the law, in one table.
TEST(ViscosityOfAScene, TakesAnEddyViscosityOnTop) {
  const test::TemporaryFolder folder;
  const Scene s = scene_with(folder, kGel + ", smagorinsky = 0.2}");
  const Plan plan = make_plan(s);
  const double rate = 0.02, tau = 0.5 + 3.0 * (ViscosityLaw(s.fluid, 4.0)(rate / plan.units.dt) *
                                                   plan.units.dt / 2.5e-7 +
                                               0.04 * rate);
  EXPECT_NEAR((*plan.kernel.parameters.viscosity_table)(std::pow(2.0 / 3.0 * rate * tau, 2)) * tau,
              1.0, 2e-4);
}

// ν = ν_min + (ν_max - ν_min) (1 + (λ γ̇)²)^((n-1)/2): ν_max at rest, and half of the way to ν_min
// where (1 + (λ γ̇)²)^((n-1)/2) is ½.
TEST(ViscosityOfAScene, IsThatOfCarreau) {
  const test::TemporaryFolder folder;
  const Scene s = scene_with(folder,
                             "viscosity = {model = \"carreau\", index = 0.4, time_constant = 2.0, "
                             "nu_min = 1e-6, nu_max = 1e-4}");
  const ViscosityLaw law(s.fluid, 4.0);
  const double half = 0.5 * std::sqrt(std::pow(2.0, 2.0 / 0.6) - 1.0);
  EXPECT_NEAR(law(0.0), 1e-4, 1e-12);
  EXPECT_NEAR(law(half), 0.5 * (1e-4 + 1e-6), 1e-10);
  EXPECT_NEAR((law(200.0) - 1e-6) / (law(100.0) - 1e-6), std::pow(2.0, -0.6), 1e-4);
}

TEST(ViscosityOfAScene, WarnsOfALawThatDoesNotAct) {
  const test::TemporaryFolder folder;
  const Plan plan = make_plan(scene_with(folder, kGel + ", nu_min = 1e-5, nu_max = 1e-4}"));
  EXPECT_TRUE(warns(plan, "the law does not act"));
  // at the walls of this channel, 400 1/s, the law has 2.5e-5 m²/s
  EXPECT_FALSE(warns(plan, "flow rate of this channel"));
  const auto bounds = [&](const std::string& both) {
    return make_plan(scene_with(folder, kGel + ", " + both + "}"));
  };
  EXPECT_TRUE(warns(bounds("nu_min = 1e-5, nu_max = 3e-5"),
                    "nu_min and nu_max change the flow rate of this channel by"));
  EXPECT_TRUE(warns(bounds("nu_min = 1e-5, nu_max = 3e-5"), "take a larger nu_max"));
  EXPECT_TRUE(warns(bounds("nu_min = 1e-4, nu_max = 1e-2"), "take a smaller nu_min"));
}

TEST(ViscosityOfAScene, WarnsOfOperatorsThatDoNotFitAYieldStress) {
  const test::TemporaryFolder folder;
  const auto warned = [&](const std::string& law, const std::string& collision,
                          const std::string& words) {
    Scene s = scene_with(folder, law);
    s.numerics.collision = from_name<CollisionOperator>(collision);
    return warns(make_plan(s), words);
  };
  const std::string mud =
      "viscosity = {model = \"bingham\", consistency = 0.1, yield_stress = 0.1, nu_max = ";
  EXPECT_TRUE(warned(mud + "5e-4}", "bgk", "yield stress through a channel"));
  EXPECT_FALSE(warned(mud + "5e-4}", "trt", "yield stress through a channel"));
  EXPECT_TRUE(warned(mud + "4e-2}", "trt", "carried along without yielding"));
  EXPECT_FALSE(warned(mud + "4e-2}", "central_moment", "carried along without yielding"));
  EXPECT_FALSE(warned(kGel + "}", "trt", "carried along without yielding"));
}

}  // namespace
