// SPDX-License-Identifier: MIT
/// The check of engines that have clumps.
#pragma once

#include "tools/engines/conformance/judge.h"

namespace conformance {

/// One clump of two discs under loads that grow: one carrier with mass, volume and inertia of the
/// union, two discs that name it, and the motion of a rigid body. @throws Wrong
void clump(Judge& judge);

}  // namespace conformance
