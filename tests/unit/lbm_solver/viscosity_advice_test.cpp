// SPDX-License-Identifier: GPL-2.0-or-later
/// What is said of viscosities that no step carries, or not in reasonable time: by the key that
/// makes them so, with advice that cures.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <optional>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/plan.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

/// Why a slot of 40 × 20 cells with a law is refused, else its warnings.
std::string said(const std::string& law, std::optional<double> step = std::nullopt) {
  const test::TemporaryFolder folder;
  try {
    Scene s = read_scene(
        {folder.write("scene.toml",
                      "[box]\nsize = [0.02, 0.01]\nsides_x = \"periodic\"\n[fluid]\n"
                      "density = 1000.0\nvelocity_scale = 0.02\nbody_force = [2.0, 0.0]\n"
                      "viscosity = {" +
                          law + "}\n[numerics]\ncell = 0.0005\n[run]\nend_time = 0.1\n")});
    s.numerics.time_step = step;
    return fmt::format("{}", fmt::join(make_plan(s).warnings, "\n"));
  } catch (const InputError& error) {
    return std::string("refused: ") + error.what();
  }
}

void expect_in(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << words << " not in: " << text;
}
void expect_out(const std::string& text, const std::string& words) {
  EXPECT_EQ(text.find(words), std::string::npos) << words << " in: " << text;
}

/// The number that stands behind some words of a text; nan where there is none.
double number_after(const std::string& text, const std::string& words) {
  expect_in(text, words);
  const auto at = text.find(words);
  return at == std::string::npos ? NAN : std::atof(text.c_str() + at + words.size());
}

// By what it costs: 2e4 steps are nothing, whatever the Bingham number; 3e7 of 800 cells take 8
// min, ten times as many are warned of.
TEST(ViscosityAdvice, TellsOfAYieldStressThatCosts) {
  const auto mud = [](const std::string& yield, const std::string& rest = "") {
    return said("model = \"bingham\", consistency = 1.0, yield_stress = " + yield + rest);
  };
  expect_out(mud("1e5"), "on a core");
  expect_in(mud("1e6"), "times as many as without it, some ");
  expect_out(mud("1e6", ", shear_rate = 4e4"), "on a core");  // where it flows
}

// 250 m²/s at 4 1/s: τ = 1.5 at 3.3e-10 s, 3e8 steps of 800 cells.
TEST(ViscosityAdvice, TellsWhatAYieldStressCostsBesideAStep) {
  const std::string mud = "model = \"bingham\", consistency = 1.0, yield_stress = 1e6";
  const std::string refused = said(mud, 1e-3);
  expect_in(refused, "yield_stress = 1e+06 Pa: is it in Pa?");
  expect_in(refused, "3e+08 steps, some 1.3 h on a core at 5e+07 cells a second");
  expect_in(said(mud, number_after(refused, "take at most ")),
            "which allows no longer step: the run takes 3e+08 steps");
}

TEST(ViscosityAdvice, CuresWhatIsAbsurd) {
  const auto gel = [](double consistency, const std::string& rest = "") {
    return fmt::format("model = \"power_law\", index = 0.5, consistency = {:.9e}{}", consistency,
                       rest);
  };
  const auto mud = [](double consistency) {
    return fmt::format("model = \"bingham\", yield_stress = 1.0, consistency = {:.9e}",
                       consistency);
  };
  const std::string thin = said(gel(1e-9)), at_least = "take it at least ";
  expect_in(thin, "consistency = 1e-09 Pa sⁿ: is it in Pa sⁿ?");
  expect_out(said(gel(1.05e-9 * number_after(thin, at_least))), "refused");
  expect_in(said(gel(1e9)),
            "consistency = 1e+09 Pa sⁿ: is it in Pa sⁿ? take it smaller, or a larger "
            "fluid.viscosity.shear_rate");
  expect_in(said(gel(1e9, ", nu_max = 1.0")),
            "is not below fluid.viscosity.nu_max = 1 m²/s; fluid.viscosity.consistency = 1e+09");
  const std::string bound = said(gel(0.5, ", nu_min = 1e-30"));
  const double least = number_after(bound, "take fluid.viscosity.nu_min = ");
  expect_out(said(gel(0.5, fmt::format(", nu_min = {}", least))), "refused");
  const std::string inviscid = said(mud(1e-9));
  expect_in(inviscid, "is consistency in Pa s?");
  expect_out(said(mud(1.05e-9 * number_after(inviscid, at_least))), "refused");
}

}  // namespace
