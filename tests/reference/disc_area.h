// SPDX-License-Identifier: GPL-2.0-or-later
/// Part of a unit cell that a disc covers, by the two rules that chords are measured against.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace test {

/// Exactly: the integral over x of what circle and cell leave of each other, piece by piece between
/// the places where the circle meets a side. @param dx, dy  cell centre minus disc centre
inline double exact_fraction(double dx, double dy, double radius) {
  const double x0 = dx - 0.5, x1 = dx + 0.5, y0 = dy - 0.5, y1 = dy + 0.5;
  const auto half = [&](double x) { return std::sqrt(std::max(0.0, (radius - x) * (radius + x))); };
  const auto integral = [&](double x) {  // of half
    return 0.5 * (x * half(x) + radius * radius * std::atan2(x, half(x)));
  };
  std::array<double, 8> places{x0, x1, -radius, radius, half(y0), -half(y0), half(y1), -half(y1)};
  for (double& x : places) x = std::clamp(x, x0, x1);
  std::sort(places.begin(), places.end());
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const double a = places[i], b = places[i + 1], h = half(0.5 * (a + b));
    if (b <= a || std::abs(0.5 * (a + b)) >= radius || h <= y0 || -h >= y1) continue;
    const double arc = integral(b) - integral(a), width = b - a;
    area += (h < y1 ? arc : y1 * width) - (-h > y0 ? -arc : y0 * width);
  }
  return area;
}

/// By n × n points.
inline double sampled_fraction(double dx, double dy, double radius, int n) {
  int inside = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = dx + (i + 0.5) / n - 0.5, y = dy + (j + 0.5) / n - 0.5;
      inside += x * x + y * y < radius * radius;
    }
  return static_cast<double>(inside) / (n * n);
}

}  // namespace test
