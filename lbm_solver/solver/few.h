// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <string>
#include <utility>

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Warnings of a kind: the first few are said, the others counted.
class Few {
 public:
  static constexpr std::size_t kSaid = 5;

  /// @param others  what is counted, as in "… and 3 more others"
  Few(Plan& plan, std::string others) : plan_(plan), others_(std::move(others)) {}
  ~Few() {
    if (count_ > kSaid)
      plan_.warnings.push_back(fmt::format("… and {} more {}", count_ - kSaid, others_));
  }
  Few(const Few&) = delete;
  Few& operator=(const Few&) = delete;
  /// @param text  gives the warning; called where it is said
  void add(const auto& text) {
    if (++count_ <= kSaid) plan_.warnings.push_back(text());
  }

 private:
  Plan& plan_;
  std::string others_;
  std::size_t count_ = 0;
};

}  // namespace lbm
