// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>

#include "lbm_solver/io/run_lock.h"

namespace lbm {

/// What becomes of an earlier run in the folder of a new one.
enum class EarlierRun {
  SetAside,  ///< its folder gets the first free name of OUT.1, OUT.2 …
  Replace,   ///< its files are removed
  GoOn       ///< they are those of the run that goes on
};

/// The folder of all output, held by one run while the object lives. A folder of ours carries the
/// file `.bplbm`, written when it is made: the program, the scene, and `file NAME` for whatever
/// lies there besides the files that lbm knows by itself (tools/run adds its pictures). Nothing
/// else is ever removed, and a folder without the mark must be new or empty.
class OutputFolder {
 public:
  /// @param path   made where it is missing
  /// @param scene  written into the mark
  /// @throws InputError  the folder is somebody else's, or another run writes into it
  OutputFolder(const std::string& path, const std::string& scene, EarlierRun earlier);

  /// Where the earlier run lies now; empty where there was none.
  const std::string& set_aside() const { return set_aside_; }

 private:
  void begin_anew(const std::string& path);

  std::optional<RunLock> lock_;
  std::string set_aside_;
};

}  // namespace lbm
