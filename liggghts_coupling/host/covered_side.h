// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <vector>

namespace dem {

using Place = std::array<double, 3>;  ///< [m]

/// Whether triangles close the way from the particles to a side of the box: what straight lines
/// across the box, begun all over the side, meet within a depth of it.
class CoveredSide {
 public:
  /// @param side   x low, x high, y low, …
  /// @param depth  from the side to the first particle [m]
  /// @param beyond  that triangles may lie outside of the side [m]
  CoveredSide(const Place& box_lo, const Place& box_hi, int dimension, int side, double depth,
              double beyond);

  void add(const std::array<Place, 3>& triangle);

  /// [line] 1 where it meets a triangle that was added; ranks with parts of a mesh take the largest
  std::vector<int>& met() { return met_; }
  bool covered() const;

 private:
  int axis_, first_, second_;                 ///< across the side, and along it
  double from_, to_;                          ///< of the lines along the axis [m]
  std::vector<std::array<double, 2>> lines_;  ///< places along the side [m]
  std::vector<int> met_;
};

}  // namespace dem
