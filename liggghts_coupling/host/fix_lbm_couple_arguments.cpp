// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/fix_lbm_couple_arguments.h"

#include "protocol/wire/numbers.h"

namespace dem {

CoupleArguments read_arguments(int narg, char** arg,
                               const std::function<void(const std::string&)>& fail) {
  const std::string usage = "; usage: fix ID group lbm/couple every N [timeout S] [record FILE]";
  CoupleArguments read;
  for (int i = 3; i < narg; i += 2) {
    const std::string key = arg[i];
    if (i + 1 == narg) fail("'" + key + "' has no value" + usage);
    const std::string value = arg[i + 1];
    if (key == "every") {
      read.substeps = protocol::to_number<int>(value).value_or(0);
      if (read.substeps < 1)
        fail("'every " + value + "': give a whole number of at least 1, e.g. ${substeps}" + usage);
    } else if (key == "timeout") {
      read.timeout = protocol::to_number<double>(value).value_or(0.0);
      if (!(*read.timeout > 0.0))
        fail("'timeout " + value + "': give a positive number of seconds" + usage);
    } else if (key == "record") {
      read.record = value;
    } else {
      fail("'" + key + "' is no keyword" + usage);
    }
  }
  if (read.substeps < 1) fail("lacks 'every N'" + usage);
  return read;
}

}  // namespace dem
