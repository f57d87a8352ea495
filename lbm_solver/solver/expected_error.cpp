// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/expected_error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {
namespace {

/// Error of the drag in per cent at some sizes, of an array with one solid fraction.
struct Row {
  double fraction;
  std::array<double, 6> diameter, error;
};

// From `scheme_report --arrays`, τ = 1: arrays of discs and of spheres.
constexpr Row kRestDiscs[] = {
    {0.05, {4.0, 5.0, 6.1, 8.1, 10.1, 15.9}, {-0.3, 0.3, 0.3, 0.1, 0.1, 0.1}},
    {0.1, {3.9, 5.0, 6.1, 7.9, 10.0, 16.1}, {-0.8, 0.3, 0.3, 0.2, 0.1, 0.1}},
    {0.2, {4.0, 5.0, 6.1, 8.1, 10.1, 16.1}, {-2.2, -0.3, -0.2, -0.2, -0.0, 0.0}},
    {0.3, {3.7, 4.9, 6.2, 8.0, 9.9, 16.1}, {-4.5, -2.1, -1.2, -0.8, -0.5, -0.1}},
    {0.4, {4.3, 5.0, 5.7, 7.9, 10.0, 15.7}, {-10.7, -5.9, -5.2, -2.1, -1.4, -0.7}},
    {0.5, {4.0, 4.8, 6.4, 8.0, 10.4, 16.0}, {-30.5, -20.6, -10.6, -6.0, -3.1, -1.4}},
};
constexpr Row kRestSpheres[] = {
    {0.064, {4.0, 5.0, 6.0, 7.9, 9.9, 15.9}, {-0.4, 0.6, 0.5, 0.8, 0.6, 0.4}},
    {0.125, {3.7, 5.0, 6.2, 8.1, 9.9, 16.1}, {-1.2, -0.1, 0.4, 0.6, 0.6, 0.5}},
    {0.343, {4.3, 5.2, 6.1, 7.8, 10.4, 15.6}, {-14.8, -8.9, -6.2, -2.1, -0.7, -0.0}},
    {0.5236, {4.0, 5.0, 6.0, 8.0, 10.0, 16.0}, {-23.8, -17.8, -15.1, -7.5, -5.0, -1.4}},
};
constexpr Row kMovingDiscs[] = {
    {0.05, {4.0, 5.0, 6.1, 8.1, 10.1, 15.9}, {-0.5, 0.2, 0.2, 0.0, 0.1, 0.0}},
    {0.1, {3.9, 5.0, 6.1, 7.9, 10.0, 16.1}, {-0.9, 0.2, 0.2, 0.1, 0.0, 0.0}},
    {0.2, {4.0, 5.0, 6.1, 8.1, 10.1, 16.1}, {-2.6, -0.5, -0.4, -0.3, -0.2, -0.1}},
    {0.3, {3.7, 4.9, 6.2, 8.0, 9.9, 16.1}, {-5.0, -2.6, -1.7, -1.1, -0.9, -0.3}},
    {0.4, {4.3, 5.0, 5.7, 7.9, 10.0, 15.7}, {-12.1, -6.9, -6.3, -2.9, -2.2, -1.2}},
    {0.5, {4.0, 4.8, 6.4, 8.0, 10.4, 16.0}, {-33.0, -22.8, -12.7, -8.0, -4.9, -2.6}},
};
constexpr Row kMovingSpheres[] = {
    {0.064, {4.0, 5.0, 6.0, 7.9, 9.9, 15.9}, {-0.4, 0.5, 0.4, 0.8, 0.6, 0.4}},
    {0.125, {3.7, 5.0, 6.2, 8.1, 9.9, 16.1}, {-1.3, -0.2, 0.3, 0.5, 0.5, 0.4}},
    {0.343, {4.3, 5.2, 6.1, 7.8, 10.4, 15.6}, {-15.3, -9.4, -6.7, -2.5, -1.1, -0.3}},
    {0.5236, {4.0, 5.0, 6.0, 8.0, 10.0, 16.0}, {-25.8, -19.5, -16.7, -8.9, -6.5, -2.5}},
};
constexpr Row kHoldychDiscs[] = {
    {0.05, {4.0, 5.0, 6.1, 8.1, 10.1, 15.9}, {-5.9, -3.4, -2.4, -1.0, -0.5, -0.0}},
    {0.1, {3.9, 5.0, 6.1, 7.9, 10.0, 16.1}, {-9.2, -5.3, -3.6, -1.7, -0.9, -0.0}},
    {0.2, {4.0, 5.0, 6.1, 8.1, 10.1, 16.1}, {-15.5, -9.6, -6.8, -3.2, -1.7, -0.1}},
    {0.3, {3.7, 4.9, 6.2, 8.0, 9.9, 16.1}, {-29.2, -17.4, -11.1, -6.1, -3.6, -0.5}},
    {0.4, {4.3, 5.0, 5.7, 7.9, 10.0, 15.7}, {-35.9, -28.2, -23.4, -12.4, -7.1, -1.7}},
    {0.5, {4.0, 4.8, 6.4, 8.0, 10.4, 16.0}, {-59.2, -50.1, -34.0, -23.4, -14.1, -4.7}},
};
constexpr Row kHoldychSpheres[] = {
    {0.064, {4.0, 5.0, 6.0, 7.9, 9.9, 15.9}, {-14.0, -8.4, -5.5, -2.1, -0.8, 0.5}},
    {0.125, {3.7, 5.0, 6.2, 8.1, 9.9, 16.1}, {-22.5, -12.4, -7.4, -3.3, -1.4, 0.6}},
    {0.343, {4.3, 5.2, 6.1, 7.8, 10.4, 15.6}, {-40.2, -30.4, -23.7, -13.9, -6.7, -1.1}},
    {0.5236, {4.0, 5.0, 6.0, 8.0, 10.0, 16.0}, {-61.5, -49.0, -38.9, -24.3, -15.7, -4.5}},
};
constexpr Row kLayeredHoldychDiscs[] = {
    {0.05, {4.0, 5.0, 6.1, 8.1, 10.1, 15.9}, {-9.0, -5.3, -3.6, -1.8, -1.0, -0.3}},
    {0.1, {3.9, 5.0, 6.1, 7.9, 10.0, 16.1}, {-12.6, -7.6, -5.6, -3.3, -1.7, -0.6}},
    {0.2, {4.0, 5.0, 6.1, 8.1, 10.1, 16.1}, {-22.9, -14.8, -10.2, -5.5, -3.2, -1.2}},
    {0.3, {3.7, 4.9, 6.2, 8.0, 9.9, 16.1}, {-37.0, -25.3, -16.2, -10.6, -7.4, -2.5}},
    {0.4, {4.3, 5.0, 5.7, 7.9, 10.0, 15.7}, {-45.4, -38.2, -36.2, -21.5, -12.8, -5.9}},
    {0.5, {4.0, 4.8, 6.4, 8.0, 10.4, 16.0}, {-72.3, -63.4, -50.6, -36.9, -27.3, -12.5}},
};
constexpr Row kLayeredHoldychSpheres[] = {
    {0.064, {4.0, 5.0, 6.0, 7.9, 9.9, 15.9}, {-15.8, -10.6, -7.1, -3.4, -1.6, 0.1}},
    {0.125, {3.7, 5.0, 6.2, 8.1, 9.9, 16.1}, {-26.1, -15.5, -10.0, -4.9, -2.8, -0.1}},
    {0.343, {4.3, 5.2, 6.1, 7.8, 10.4, 15.6}, {-45.3, -37.0, -28.7, -17.8, -11.5, -3.6}},
    {0.5236, {4.0, 5.0, 6.0, 8.0, 10.0, 16.0}, {-70.3, -59.5, -49.0, -35.2, -25.8, -11.0}},
};

std::span<const Row> rows_of(SolidTerm term, int dimension) {
  const bool flat = dimension == 2;
  const auto pick = [flat](std::span<const Row> discs, std::span<const Row> spheres) {
    return flat ? discs : spheres;
  };
  if (term == SolidTerm::Resistance) return pick(kRestDiscs, kRestSpheres);
  if (term == SolidTerm::LayeredResistance) return pick(kMovingDiscs, kMovingSpheres);
  if (term == SolidTerm::Holdych) return pick(kHoldychDiscs, kHoldychSpheres);
  if (term == SolidTerm::LayeredHoldych) return pick(kLayeredHoldychDiscs, kLayeredHoldychSpheres);
  return {};
}

/// Between two places of a row, linear; above its end as 1/D², which errors fall with; below its
/// start the error there.
double at_diameter(const Row& row, double diameter) {
  const auto& d = row.diameter;
  if (diameter >= d.back()) return row.error.back() * std::pow(d.back() / diameter, 2);
  std::size_t i = 1;
  while (i + 1 < d.size() && d[i] < diameter) ++i;
  const double part = std::max(0.0, (diameter - d[i - 1]) / (d[i] - d[i - 1]));
  return std::lerp(row.error[i - 1], row.error[i], part);
}

// Central moments with layered Noble–Torczynski: discs, c = 0.2, by relaxation time and size.
constexpr double kTaus[] = {0.505, 0.6, 1.0, 1.5}, kSizes[] = {5.0, 10.0, 20.0};
constexpr double kCentralMoments[][4] = {
    {8.6, -9.7, -28.2, -41.2}, {5.9, -2.6, -10.3, -17.5}, {3.7, -0.5, -3.5, -6.6}};

/// Place among the numbers of a list: the one before, and the part of the way to the next.
std::pair<std::size_t, double> place_in(std::span<const double> list, double x) {
  std::size_t i = 0;
  while (i + 2 < list.size() && list[i + 1] < x) ++i;
  return {i, std::clamp((x - list[i]) / (list[i + 1] - list[i]), 0.0, 1.0)};
}

ExpectedError of_central_moments(double tau, double diameter) {
  const auto [i, along] = place_in(kTaus, tau);
  const auto [k, size] = place_in(kSizes, diameter);
  const auto at = [&, i = i, along = along](const double(&row)[4]) {
    return std::lerp(row[i], row[i + 1], along);
  };
  const double error = std::lerp(at(kCentralMoments[k]), at(kCentralMoments[k + 1]), size);
  return {error * std::min(1.0, kSizes[2] / diameter), diameter < kSizes[0]};
}

/// Whether the tables of arrays, which were made with TRT and each term's own Λ, hold.
bool tabulated(const KernelChoice& k) {
  return k.collision == CollisionOperator::Trt && !k.local_viscosity() &&
         k.parameters.magic == (by_resistance(k.solid_term) ? kResistanceMagic : kHalfWayMagic);
}

}  // namespace

std::optional<ExpectedError> expected_error(const KernelChoice& kernel, int dimension,
                                            double fraction, double diameter) {
  if (dimension == 2 && kernel.collision == CollisionOperator::CentralMoment &&
      kernel.solid_term == SolidTerm::LayeredNobleTorczynski)
    return of_central_moments(kernel.parameters.tau, diameter);
  const std::span<const Row> rows = rows_of(kernel.solid_term, dimension);
  if (rows.empty() || !tabulated(kernel)) return std::nullopt;
  std::size_t i = 1;
  while (i + 1 < rows.size() && rows[i].fraction < fraction) ++i;
  const Row &low = rows[i - 1], &high = rows[i];
  const double part =
      std::clamp((fraction - low.fraction) / (high.fraction - low.fraction), 0.0, 1.0);
  return ExpectedError{
      std::lerp(at_diameter(low, diameter), at_diameter(high, diameter), part),
      fraction > rows.back().fraction * 1.001 || diameter < high.diameter.front() - 0.5};
}

namespace {

constexpr double kLargeError = 5.0;  // per cent of drag, above which a scene is warned

/// Part of the box that the discs or spheres cover of which the scene knows: obstacles, and the
/// particles that it starts; 0 where there are none.
double fraction_known(const Scene& s) {
  double covered = 0.0, box = s.box.dimension == 2 ? s.box.depth : 1.0;
  for (int k = 0; k < s.box.dimension; ++k) box *= s.box.size[k];
  for (const ObstacleScene& o : s.obstacles)
    if (o.round && !o.hollow) covered += particle_volume(s, o.diameter);
  if (s.particles && s.coupling)
    covered += static_cast<double>(s.particles->start.size()) *
               particle_volume(s, s.particles->diameter.hi);
  return covered / box;
}

std::string text_of(const ExpectedError& error) {
  const double shown = std::abs(error.percent) < 0.05 ? 0.0 : error.percent;
  return error.at_least ? fmt::format("more than {:.1f} %", std::abs(shown))
                        : fmt::format("{:+.1f} %", shown);
}

/// Of what there is no table of errors: a law, or a Λ, where without it there would be one.
std::string not_tabulated(const KernelChoice& k, int dimension) {
  const std::string both = fmt::format("{} with {}", name_of(k.collision), name_of(k.solid_term));
  if (k.parameters.viscosity_table) return both + " and a viscosity that depends on the shear rate";
  if (k.local_viscosity()) return both + " and a turbulence model";
  KernelChoice usual = k;
  usual.parameters.magic = by_resistance(k.solid_term) ? kResistanceMagic : kHalfWayMagic;
  return expected_error(usual, dimension, kLooseBed[dimension - 2], kSizes[1])
             ? fmt::format("{} and Λ = {:.4g}", both, k.parameters.magic)
             : both;
}

}  // namespace

void expect_error(const Scene& s, Plan& plan) {
  double smallest = s.particles ? s.particles->diameter.lo : 0.0;
  for (const ObstacleScene& o : s.obstacles) {
    if (o.round && o.hollow) return;
    if (o.round && (smallest == 0.0 || o.diameter < smallest)) smallest = o.diameter;
  }
  if (smallest == 0.0 || (!s.coupling && plan.reynolds > 1.0)) return;
  const int d = s.box.dimension;
  const double ratio = s.particles ? std::ranges::min(s.particles->hydraulic_ratio) : 1.0;
  const double cells = ratio * smallest / plan.units.dx;
  std::vector<double> fractions{fraction_known(s)};
  const bool brought = s.particles && s.coupling && s.particles->start.empty();
  if (brought ||
      fractions[0] == 0.0) {  // the script brings the particles: a loose bed, a dense one
    fractions[0] = kLooseBed[d - 2];
    if (plan.kernel.collision == CollisionOperator::Trt)
      fractions.push_back(std::min(kDenseBed[d - 2], kPackedBed[d - 2] * std::pow(ratio, d)));
  }
  ExpectedError worst;
  double where = 0.0;
  for (const double fraction : fractions) {
    const auto error = expected_error(plan.kernel, d, fraction, cells);
    if (!error) {
      plan.expected_error =
          fmt::format("of the drag: not tabulated for {}: compare with a finer cell",
                      not_tabulated(plan.kernel, d));
      return;
    }
    plan.expected_error +=
        fmt::format("{}{} at a solid fraction of {:.3g}",
                    plan.expected_error.empty() ? "drag " : ", ", text_of(*error), fraction);
    if (error->at_least || std::abs(error->percent) > std::abs(worst.percent))
      worst = *error, where = fraction;
  }
  plan.expected_error +=
      by_resistance(plan.kernel.solid_term)
          ? " [slow flow through regular arrays]"
          : fmt::format(
                " [slow flow through regular arrays, τ = {:.3g}]",
                plan.kernel.collision == CollisionOperator::Trt ? 1.0 : plan.kernel.parameters.tau);
  if (worst.at_least || std::abs(worst.percent) > kLargeError)
    plan.warnings.push_back(
        fmt::format("with {:.3g} cells a diameter the drag is {} {:.0f} % off at a solid fraction "
                    "of {:.3g}; take more cells if the bed is that dense",
                    cells, worst.at_least ? "more than" : "some", std::abs(worst.percent), where));
}

}  // namespace lbm
