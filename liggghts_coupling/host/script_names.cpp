// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/script_names.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>

namespace dem {
namespace {

constexpr int kDeepest = 8;  // of files that include others

struct Names {
  const VariableValue& value;
  std::set<std::string> defined;
  std::vector<std::pair<std::string, std::string>> used;  // name, place

  void read(const std::string& file, int depth);
  std::string filled(std::string path) const;
};

/// A path with the values of its variables.
std::string Names::filled(std::string path) const {
  static const std::regex use(R"(\$\{(\w+)\})");
  for (std::smatch found; std::regex_search(path, found, use);) {
    const auto known = value(found[1]);
    if (!known) return {};
    path = found.prefix().str() + *known + found.suffix().str();
  }
  return path;
}

void Names::read(const std::string& file, int depth) {
  static const std::regex definition(R"(\bvariable\s+(\w+)\s)"), use(R"(\$\{(\w+)\})"),
      inclusion(R"(\binclude\s+(\S+))");
  std::ifstream text(file);
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    const auto each = [&line](const std::regex& what, auto&& take) {
      for (std::sregex_iterator found(line.begin(), line.end(), what), end; found != end; ++found)
        take((*found)[1].str());
    };
    each(definition, [&](const std::string& name) { defined.insert(name); });
    each(use, [&](const std::string& name) {
      used.emplace_back(name, fmt::format("{}:{}", file, number));
    });
    each(inclusion, [&](const std::string& path) {
      if (depth < kDeepest) read(filled(path), depth + 1);
    });
  }
}

}  // namespace

std::vector<std::string> undefined_names(const std::string& script, const VariableValue& value) {
  Names names{value, {}, {}};
  names.read(script, 0);
  std::vector<std::string> undefined;
  for (const auto& [name, place] : names.used)
    if (!value(name) && names.defined.insert(name).second)  // said once
      undefined.push_back(fmt::format("${{{}}} ({})", name, place));
  return undefined;
}

}  // namespace dem
