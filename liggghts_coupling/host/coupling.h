// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/session.h"

namespace dem {

/// The coupled job as this process sees it. `main` makes it before LIGGGHTS exists, `fix
/// lbm/couple` uses it: LIGGGHTS offers no other way to hand something to a fix.
struct Coupling {
  protocol::World world;
  std::unique_ptr<protocol::Channel> channel;       ///< null when liggghts was started alone
  std::unique_ptr<protocol::SolidSession> session;  ///< null likewise
  bool agreed = false;  ///< hellos exchanged: the fluid waits for states
  bool over = false;    ///< the last states are sent

  static Coupling& instance();
};

}  // namespace dem
