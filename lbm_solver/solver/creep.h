// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {

/// What bounds and regularisation of a law with a consistency do to the flow rate of a plane
/// channel, over that of the law without them, less 1. With a stress σ that grows from the middle
/// to σ_w at the walls the flow rate is ∝ ∫ σ γ̇(σ) dσ, here by quadrature.
/// @param wall_rate  shear rate at the walls that the law without bounds has [1/s], positive
double creep_in_channel(const FluidScene& fluid, const ViscosityLaw& law, double wall_rate);

/// Part of that channel's width that does not yield: σ_y/σ_w.
double plug_in_channel(const FluidScene& fluid, double wall_rate);

}  // namespace lbm
