// SPDX-License-Identifier: GPL-2.0-or-later
/// Drag of regular arrays in Stokes flow, by solid fraction, and the places of a body within a cell
/// over which errors of them are means.
#pragma once

#include <map>
#include <vector>

#include "lbm_solver/base/vec3.h"

namespace test {

/// F/(μU) of square arrays of discs, U the mean flux: from a spectral solution of our own, which
/// agrees with Sangani and Acrivos (1982) within 0.03 %.
inline const std::map<double, double> kDiscDrag{{0.05, 15.557822}, {0.1, 24.831675},
                                                {0.2, 51.526949},  {0.3, 102.881304},
                                                {0.4, 217.894315}, {0.5, 532.548118}};

/// F/(6πμaU) of simple cubic arrays of spheres [Zick and Homsy 1982]; three digits from 0.343 on.
inline const std::map<double, double> kSphereDrag{
    {0.064, 2.810}, {0.125, 4.292}, {0.343, 15.4}, {0.5236, 42.1}};

/// Of a body's centre, from a cell's corner [cells]; z in three dimensions only.
inline const std::vector<lbm::Vec3> kPlacesInACell{
    {0.0, 0.0, 0.0}, {0.5, 0.5, 0.5}, {0.23, 0.41, 0.12}, {0.37, 0.12, 0.45}};

}  // namespace test
