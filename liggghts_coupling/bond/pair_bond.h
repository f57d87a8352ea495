// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace dem {

/// Makes `pair_style gran model bond/contact` and `bond/parallel` known to LIGGGHTS. Before the
/// first input line.
void register_bonds();

}  // namespace dem
