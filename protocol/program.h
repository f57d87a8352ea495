// SPDX-License-Identifier: MIT
/// How a program of a coupled job ends when something went wrong.
#pragma once

#include <exception>
#include <string>

#include "protocol/channel.h"

namespace protocol {

/// Exit code that an exception stands for: that of a ProtocolError, else kFault.
int exit_code_of(const std::exception& error);

/// Ends a failing program: prints `<program> | error | <text>`; unless the partner already knows
/// (PeerFault), tells it and waits until it has cleaned up; then ends the whole MPI job.
/// Refusal and PeerLeft return the exit code instead: both programs then leave in good order.
/// @param channel  null before there is a partner
int leave_after(const std::exception& error, const std::string& program, Channel* channel);

/// From now on SIGTERM and SIGINT do not kill at once: the next wait of a channel, or
/// `throw_if_signalled`, throws ProtocolError. mpirun sends SIGTERM to the survivors when a program
/// of the job dies.
void catch_signals();
void throw_if_signalled();

/// Ends the whole MPI job now, flushing the standard streams first.
[[noreturn]] void abort_job(int exit_code);

}  // namespace protocol
