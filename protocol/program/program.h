// SPDX-License-Identifier: MIT
/// How a program of a coupled job ends when something went wrong.
#pragma once

#include <mpi.h>

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "protocol/wire/channel.h"

namespace protocol {

/// Exit code that an exception stands for: that of a ProgramError, else kFault.
int exit_code_of(const std::exception& error);

/// What a failing program leaves behind.
struct Parting {
  int exit_code = kFault;
  bool in_order = false;  ///< as after Refusal and PeerLeft: both programs go on to `finish`
};

/// Prints `<program> | error | <text>`; unless the partner already knows (PeerFault) or both leave
/// in good order, tells it and waits until it has cleaned up.
/// @param channel  null before there is a partner
Parting part_after(const std::exception& error, const std::string& program, Channel* channel);

/// Ends a failing program: `part_after`, then the end of the whole MPI job; in good order it
/// returns the exit code instead.
int leave_after(const std::exception& error, const std::string& program, Channel* channel);

/// The end of every program of a job, in place of MPI_Finalize: waits for the ranks of its own
/// program, says farewell, waits for the partner's, and finalises MPI. No wait is longer than the
/// limit of `limit_waits`, or a minute: see "The end of a job" in WIRE.md. A partner that fails
/// meanwhile, or stands still, ends the job.
/// @param channel  null where there is no partner; null afterwards
/// @param local    the ranks of this program; null where there was no `connect`
/// @return the exit code
int finish(int exit_code, const std::string& program, std::unique_ptr<Channel>& channel,
           MPI_Comm local);

/// Last line that begins with ERROR, as LAMMPS and LIGGGHTS write it, of some files; empty where
/// there is none.
std::string last_error_line(const std::vector<std::string>& files);

/// Ends a program whose engine has ended itself, as LAMMPS and LIGGGHTS do after an error: tells
/// the partner the reason, and ends the whole MPI job.
/// @param lonely  this rank alone comes here; else all of its program do
[[noreturn]] void end_with_engine(const std::string& reason, Channel* channel, bool lonely);

/// From now on SIGTERM and SIGINT do not kill at once. mpirun sends SIGTERM to the survivors when a
/// program of the job dies, and to all when it is told to end.
void catch_signals();
/// Whether one has come: the fluid then ends the run at the next interval at which it may be
/// stopped, in good order.
bool signalled();
/// The partner has answered: it lives, and the run goes on until that interval.
void note_answer();
/// @throws ProgramError  where a signal and the partner's last answer came longer ago than a grace
/// of 0.6 s (BPLBM_GRACE), in which a living partner would have answered
void throw_if_signalled();

/// What a failing program still does has so many seconds; then the process says why it failed and
/// ends. Collective work of several ranks can wait for one that is no longer there.
class Deadline {
 public:
  /// @param error  what it fails of: the text and the exit code where the time is up
  Deadline(const std::exception& error, const std::string& program, unsigned seconds = 5);
  ~Deadline();
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
};

/// Ends the whole MPI job now, flushing the standard streams first.
[[noreturn]] void abort_job(int exit_code);

}  // namespace protocol
