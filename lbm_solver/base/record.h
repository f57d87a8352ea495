// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lbm_solver/base/cell_values.h"

namespace lbm {

/// What an object needs to go on as if it had never stopped: its values, those of cells, and those
/// of its parts, by name. Every class whose state a checkpoint keeps has `Record save() const` and
/// `void load(const Record&)`, which stand side by side and name the same values.
class Record {
 public:
  using Value = std::variant<std::int64_t, double, std::string, std::vector<std::int64_t>,
                             std::vector<double>>;

  void set(const std::string& name, Value value) { values_[name] = std::move(value); }
  void set(const std::string& name, Record part) { parts_[name] = std::move(part); }
  void set(const std::string& name, CellValues values) { cells_[name] = std::move(values); }

  /// @throws std::invalid_argument  there is no such value, or it is of another type
  template <class T>
  const T& get(const std::string& name) const {
    const auto found = values_.find(name);
    const T* value = found == values_.end() ? nullptr : std::get_if<T>(&found->second);
    if (!value)
      throw std::invalid_argument(
          "'" + name + (found == values_.end() ? "' is missing" : "' is of another type"));
    return *value;
  }
  std::int64_t integer(const std::string& name) const { return get<std::int64_t>(name); }
  double real(const std::string& name) const { return get<double>(name); }
  /// A list of a known length. @throws std::invalid_argument  likewise, or it is of another one
  template <class T>
  const std::vector<T>& list(const std::string& name, std::size_t size) const {
    const auto& values = get<std::vector<T>>(name);
    if (values.size() != size) throw std::invalid_argument("'" + name + "' is of another size");
    return values;
  }
  /// @throws std::invalid_argument  there is no such part
  const Record& part(const std::string& name) const {
    const auto found = parts_.find(name);
    if (found == parts_.end()) throw std::invalid_argument("'" + name + "' is missing");
    return found->second;
  }

  /// Values of the cells of a box. @throws std::invalid_argument  there are none, or of another box
  const CellValues& cells(const std::string& name, const Cell3& box, int components) const {
    const auto found = cells_.find(name);
    if (found == cells_.end())
      throw std::invalid_argument(
          "'" + name + (values_.contains(name) ? "' is of an earlier version" : "' is missing"));
    if (found->second.box != box || found->second.components != components)
      throw std::invalid_argument("'" + name + "' is of another size");
    return found->second;
  }
  /// The same record, which no longer depends on the objects that it was saved from.
  Record kept() const {
    Record record = *this;
    for (auto& [name, values] : record.cells_) values = values.kept();
    for (auto& [name, part] : record.parts_) part = part.kept();
    return record;
  }

  const std::map<std::string, Value>& values() const { return values_; }
  std::map<std::string, Value>& values() { return values_; }
  const std::map<std::string, Record>& parts() const { return parts_; }
  const std::map<std::string, CellValues>& cells() const { return cells_; }
  bool operator==(const Record&) const = default;

 private:
  std::map<std::string, Value> values_;
  std::map<std::string, Record> parts_;
  std::map<std::string, CellValues> cells_;
};

}  // namespace lbm
