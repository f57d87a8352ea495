// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace protocol {

/// Bounds MPI_Init while it lives. There a program waits for every other one of its mpirun, also
/// for one that has ended before or hangs; then this process says so and ends, and mpirun ends the
/// rest.
class MpiStart {
 public:
  /// @param program  its name in the message
  /// @param seconds  that a partner may take to start: twice as many are waited for, a minute at
  ///                 least; exactly BPLBM_CONNECT_TIMEOUT where the environment has that
  explicit MpiStart(std::string program, double seconds = 60.0);
  ~MpiStart();
  MpiStart(const MpiStart&) = delete;
  MpiStart& operator=(const MpiStart&) = delete;

 private:
  void watch();

  const std::string program_;
  const double limit_;
  std::mutex mutex_;
  std::condition_variable begun_condition_;
  bool begun_ = false;
  std::thread thread_;
};

}  // namespace protocol
