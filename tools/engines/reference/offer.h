// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/core.h>

#include <map>
#include <string>

#include "protocol/wire/errors.h"
#include "protocol/wire/numbers.h"

namespace engine {

/// Numbers and texts that the fluid offers.
class Offer {
 public:
  explicit Offer(const protocol::Hello& fluid) {
    for (const protocol::Variable& v : fluid.variables) values_[v.name] = v.value;
  }
  double number(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end())
      throw protocol::ProgramError(fmt::format("the fluid offers no variable '{}'", name),
                                   protocol::kBadInput);
    const auto value = protocol::to_number<double>(found->second);
    if (!value)
      throw protocol::ProgramError(
          fmt::format("the fluid's variable '{}' = '{}' is no number; correct "
                      "[particles.variables] of the scene",
                      name, found->second),
          protocol::kBadInput);
    return *value;
  }
  double number_or(const std::string& name, double otherwise) const {
    return values_.contains(name) ? number(name) : otherwise;
  }
  std::string text(const std::string& name) const { return values_.at(name); }
  bool has(const std::string& name) const { return values_.contains(name); }

 private:
  std::map<std::string, std::string> values_;
};

}  // namespace engine
