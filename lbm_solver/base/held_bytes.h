// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace lbm {

/// Bytes that a list has taken for its elements, also for those that it has room for only.
template <class T>
std::size_t held(const std::vector<T>& list) {
  return list.capacity() * sizeof(T);
}

}  // namespace lbm
