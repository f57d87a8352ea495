// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/wire/codec.h"
#include "protocol/wire/errors.h"

namespace protocol {

/// How long a wait may last, and what to say when it lasted longer.
struct Wait {
  double seconds = 300.0;
  std::string what;  ///< e.g. "states of interval 12"
};

/// What was heard while a farewell was waited for.
struct Ending {
  std::vector<int> missing;    ///< remote ranks that have not said it
  std::optional<Fault> fault;  ///< a remote rank has failed instead
};

/// Frames between one rank of this side and the ranks of the other side.
///
/// Contract, the same for every transport:
/// - frames from A to B arrive once, whole and in the order sent;
/// - when `send` returns the frame belongs to the transport: nothing need be kept, but it may not
///   have arrived;
/// - `receive` returns the next frame of that remote rank, of whatever kind;
/// - a fault overtakes everything: any `send` or `receive` in progress throws PeerFault;
/// - a rank that has said farewell sends nothing more: `receive` from it throws PeerLeft;
/// - no call waits longer than its limit: then it throws Timeout.
class Channel {
 public:
  virtual ~Channel() = default;

  virtual int local_rank() const = 0;
  virtual int remote_size() const = 0;
  /// Name of the other side for messages, e.g. "solid".
  virtual std::string remote_name() const = 0;

  /// @throws PeerFault, Timeout
  virtual void send(int remote, Bytes frame, const Wait& wait) = 0;
  /// @throws PeerFault, PeerLeft, Timeout
  virtual Bytes receive(int remote, const Wait& wait) = 0;

  /// Tells every remote rank that this side fails. Never throws, never waits for long.
  virtual void raise(const Fault& fault) noexcept = 0;
  /// Waits until every remote rank said farewell, at most `seconds`. After `raise` a fault of a
  /// remote rank counts as its farewell; else it ends the wait.
  virtual Ending await_farewell(double seconds) noexcept = 0;
  /// "I send and need nothing more": at the end in good order, and after PeerFault.
  virtual void say_farewell() noexcept = 0;
};

/// The sentence of a Timeout.
std::string timeout_text(const Channel& channel, int remote, const Wait& wait);

}  // namespace protocol
