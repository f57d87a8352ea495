// SPDX-License-Identifier: GPL-2.0-or-later
/// Laws of viscosity and drives in time as a scene gives them: what is refused, and what the plan
/// makes of the rest.
#include <gtest/gtest.h>

#include <algorithm>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
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
  EXPECT_EQ(describe_viscosity(s, plan).size(), 3u);
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
  EXPECT_TRUE(std::ranges::any_of(plan.warnings, [](const std::string& w) {
    return w.find("the law does not act") != std::string::npos;
  }));
}

TEST(ViscosityOfAScene, WarnsOfOperatorsThatDoNotFitAYieldStress) {
  const test::TemporaryFolder folder;
  const auto warned = [&](const std::string& law, const std::string& collision,
                          const std::string& words) {
    Scene s = scene_with(folder, law);
    s.numerics.collision = from_name<CollisionOperator>(collision);
    return std::ranges::any_of(make_plan(s).warnings, [&](const std::string& w) {
      return w.find(words) != std::string::npos;
    });
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
