// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/boundary_trace.h"

#include <algorithm>
#include <cmath>

namespace lbm {
namespace {

using Cell = BoundaryTrace::Cell;

/// The next cell in a direction: 1 W, 2 N, 3 E, 4 S, and on around in either sense.
Cell next(const Cell& c, int direction) {
  switch (((direction - 1) % 4 + 4) % 4) {
    case 0:
      return {c.x - 1, c.y};
    case 1:
      return {c.x, c.y + 1};
    case 2:
      return {c.x + 1, c.y};
    default:
      return {c.x, c.y - 1};
  }
}

}  // namespace

BoundaryTrace trace_boundary(const Vec3& centre, double radius) {
  const auto inside = [&](const Cell& c) {
    const double dx = c.x + 0.5 - centre.x(), dy = c.y + 0.5 - centre.y();
    return dx * dx + dy * dy < radius * radius;
  };
  const auto column = static_cast<int>(std::floor(centre.x()));  // the cell around the centre
  Cell start{column, static_cast<int>(std::floor(centre.y() - radius)) - 1};
  while (!inside(start)) ++start.y;

  BoundaryTrace trace;
  int current = 1, reference = 1;
  for (Cell at = start;;) {
    const Cell to = next(at, current);
    if (!inside(to)) {
      ++current;
      if (current - 2 == reference) ++reference;
      continue;
    }
    at = to;
    trace.solid.push_back(at);
    current = std::max(current - 1, reference);
    if (at == start) break;
  }

  const Cell below{start.x, start.y - 1};
  current = 1;
  reference = 2;
  for (Cell at = below;;) {
    const Cell to = next(at, current);
    if (inside(to)) {
      --current;
      continue;
    }
    at = to;
    trace.fluid.push_back(at);
    reference = current + 1;
    if (!inside(next(at, reference)))
      ++current;
    else if (inside(next(at, current)))
      --current;
    if (at == below) break;
  }
  return trace;
}

}  // namespace lbm
