// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/expected_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "lbm_solver/immersed/resistance.h"

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
         k.parameters.magic == (by_resistance(k.solid_term) ? kResistanceMagic : 3.0 / 16.0);
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

}  // namespace lbm
