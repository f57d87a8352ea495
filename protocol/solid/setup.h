// SPDX-License-Identifier: MIT
/// What both sides agree on, as the C interface has it and as a handshake.
#pragma once

#include "protocol/solid/bplbm_solid.h"
#include "protocol/wire/messages.h"

namespace protocol {

/// What the fluid's scene says, as a solid would compute with it.
bplbm_setup setup_of(const Hello& fluid);
/// What a solid computes with; without the program's name.
Hello hello_of(const bplbm_setup& setup);

}  // namespace protocol
