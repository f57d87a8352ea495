// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/table_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <sstream>
#include <utility>

#include "lbm_solver/base/errors.h"

namespace lbm {
namespace {

std::string shown(const toml::node& node) {
  if (node.is_floating_point()) return fmt::format("{}", *node.value<double>());
  if (const toml::array* list = node.as_array()) {
    std::string items;
    for (const toml::node& item : *list) items += (items.empty() ? "" : ", ") + shown(item);
    return "[" + items + "]";
  }
  std::ostringstream text;
  node.visit([&text](const auto& n) { text << n; });
  return text.str();
}

const toml::table& no_table() {
  static const toml::table empty;
  return empty;
}

std::string bounds_text(const Bounds& b, const std::string& unit) {
  const std::string u = unit.empty() ? "" : " " + unit;
  if (b.exclusive && b.lo == 0.0 && std::isinf(b.hi))
    return "a positive number" + (unit.empty() ? "" : " [" + unit + "]");
  if (std::isinf(b.lo) && std::isinf(b.hi)) return "a number" + u;
  if (std::isinf(b.hi)) return fmt::format("a number of at least {}{}", b.lo, u);
  return fmt::format("a number from {} to {}{}", b.lo, b.hi, u);
}

/// The smallest number of letters to change, add or take away that makes one word of the other.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t corner = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = corner + (a[i - 1] == b[j - 1] ? 0 : 1);
      corner = std::exchange(row[j], std::min({changed, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row.back();
}

/// In a table of keys; empty where any number will do.
std::string range_text(const Bounds& b) {
  if (b.exclusive && std::isinf(b.hi)) return fmt::format("> {}", b.lo);
  if (std::isinf(b.lo) && std::isinf(b.hi)) return {};
  if (std::isinf(b.hi)) return fmt::format("≥ {}", b.lo);
  return fmt::format("{} … {}", b.lo, b.hi);
}

/// What stands between the brackets of "[m] along the side", or all of it.
std::string bare_unit(const std::string& unit) {
  const auto begin = unit.find('['), end = unit.find(']');
  return begin == std::string::npos || end < begin ? unit : unit.substr(begin + 1, end - begin - 1);
}

constexpr const char* kRequired = "required";

/// Adds to a list of alternatives what it does not hold yet.
void add_alternatives(std::string& list, const std::string& more) {
  std::istringstream words(more);
  for (std::string word; std::getline(words, word, '|');) {
    const std::string padded = "|" + list + "|";
    if (padded.find("|" + word + "|") == std::string::npos)
      list += (list.empty() ? "" : "|") + word;
  }
}

}  // namespace

void KeyNotes::add(const KeyNote& note) {
  const auto known = std::find_if(notes_.begin(), notes_.end(),
                                  [&](const KeyNote& n) { return n.key == note.key; });
  if (known == notes_.end()) {
    notes_.push_back(note);
    return;
  }
  add_alternatives(known->type, note.type);
  if (note.type == "choice") add_alternatives(known->range, note.range);
}

TableReader::TableReader(const toml::table& table, std::string path, std::string file,
                         std::map<std::string, std::string>* settings, KeyNotes* keys)
    : table_(table),
      path_(std::move(path)),
      file_(std::move(file)),
      name_(path_),
      settings_(settings),
      keys_(keys) {}

void TableReader::describe(const std::string& key, const std::string& type, const std::string& unit,
                           const std::string& fallback, const std::string& range) const {
  if (keys_) keys_->add({full(key), type, bare_unit(unit), fallback, range});
}

void TableReader::note(const std::string& key, const std::string& value) const {
  if (settings_) (*settings_)[name_.empty() ? key : name_ + "." + key] = value;
}

std::string TableReader::place(const toml::node& node) const {
  const toml::source_region& source = node.source();
  if (!source.path || source.begin.line == 0) return file_;
  return fmt::format("{}:{}", *source.path, source.begin.line);
}

std::string TableReader::place() const {
  return place(table_);
}

std::string TableReader::where(const toml::node* node, const std::string& key) const {
  return fmt::format("{}: {}", node ? place(*node) : place(), full(key));
}

void TableReader::fail(const std::string& key, const std::string& problem,
                       const std::string& remedy) const {
  throw InputError(where(table_.get(key), key) + " " + problem, remedy);
}

bool TableReader::has(const std::string& key) {
  known_.insert(key);
  return table_.contains(key);
}

const toml::node* TableReader::find(const std::string& key) {
  asked_.insert(key);
  known_.insert(key);
  return table_.get(key);
}

std::string TableReader::misspelt(const std::string& key) const {
  for (const auto& [other, node] : table_)
    if (const std::string name(other.str()); !asked_.contains(name) && distance(key, name) <= 2)
      return fmt::format(", but there is '{}'", name);
  return {};
}

const toml::node& TableReader::need(const std::string& key, const std::string& what) {
  const toml::node* node = find(key);
  if (!node) throw InputError(where(nullptr, key) + " is missing" + misspelt(key), "give " + what);
  return *node;
}

TableReader TableReader::table(const std::string& key) {
  const toml::node& node = need(key, "a table [" + key + "]");
  if (!node.is_table()) fail(key, "= " + shown(node) + " is no table", "write [" + key + "]");
  return {*node.as_table(), full(key), file_, settings_, keys_};
}

TableReader TableReader::optional_table(const std::string& key) {
  asked_.insert(key);
  if (has(key)) return table(key);
  return {no_table(), full(key), file_, settings_, keys_};
}

std::vector<TableReader> TableReader::tables(const std::string& key) {
  std::vector<TableReader> result;
  const toml::node* node = find(key);
  if (!node) return result;
  if (!node->is_array_of_tables()) fail(key, "is no list of tables", "write [[" + key + "]]");
  for (const toml::node& entry : *node->as_array()) {
    result.emplace_back(*entry.as_table(), key, file_, settings_, keys_);
    result.back().name_ = fmt::format("{}.{}", key, result.size());
  }
  return result;
}

double TableReader::to_number(const toml::node& node, const std::string& key, const Bounds& bounds,
                              const std::string& unit) const {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  const bool inside = value && std::isfinite(*value) &&
                      (bounds.exclusive ? *value > bounds.lo && *value < bounds.hi
                                        : *value >= bounds.lo && *value <= bounds.hi);
  if (!inside) {
    const std::string problem = value ? "is out of range" : "is not a number";
    throw InputError(where(&node, key) + fmt::format(" = {} {}", shown(node), problem),
                     "give " + bounds_text(bounds, unit));
  }
  return *value;
}

double TableReader::number(const std::string& key, const Bounds& bounds, const std::string& unit) {
  describe(key, "number", unit, kRequired, range_text(bounds));
  const double value = to_number(need(key, bounds_text(bounds, unit)), key, bounds, unit);
  note(key, fmt::format("{}", value));
  return value;
}
double TableReader::number_or(const std::string& key, double fallback, const Bounds& bounds,
                              const std::string& unit) {
  describe(key, "number", unit, fmt::format("{}", fallback), range_text(bounds));
  const double value = optional_number(key, bounds, unit).value_or(fallback);
  note(key, fmt::format("{}", value));
  return value;
}
std::optional<double> TableReader::optional_number(const std::string& key, const Bounds& bounds,
                                                   const std::string& unit) {
  describe(key, "number", unit, "", range_text(bounds));
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const double value = to_number(*node, key, bounds, unit);
  note(key, fmt::format("{}", value));
  return value;
}

std::optional<int> TableReader::optional_integer(const std::string& key, int least) {
  describe(key, "integer", "", "", fmt::format("≥ {}", least));
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const auto value = node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (!value || *value < least || *value > 1000000000)
    fail(key, fmt::format("= {} must be an integer ≥ {}", shown(*node), least),
         fmt::format("give a whole number from {}", least));
  note(key, fmt::format("{}", *value));
  return static_cast<int>(*value);
}

bool TableReader::flag_or(const std::string& key, bool fallback) {
  describe(key, "true or false", "", fallback ? "true" : "false", "");
  const toml::node* node = find(key);
  if (node && !node->is_boolean())
    fail(key, fmt::format("= {} is neither true nor false", shown(*node)), "give true or false");
  const bool value = node ? *node->value<bool>() : fallback;
  note(key, value ? "true" : "false");
  return value;
}

std::string TableReader::text_or(const std::string& key, const std::string& fallback) {
  describe(key, "text", "", "", "");
  return text(key, fallback);
}

std::string TableReader::text(const std::string& key, const std::string& fallback) {
  const toml::node* node = find(key);
  if (node && !node->is_string())
    fail(key, fmt::format("= {} is no text", shown(*node)), "put it in quotation marks");
  const std::string value = node ? *node->value<std::string>() : fallback;
  note(key, value);
  return value;
}

std::string TableReader::choice_or(const std::string& key, const std::string& fallback,
                                   const std::vector<std::string>& known) {
  describe(key, "choice", "", fallback.empty() ? kRequired : "\"" + fallback + "\"",
           fmt::format("{}", fmt::join(known, "|")));
  const std::string value = text(key, fallback);
  for (const auto& k : known)
    if (value == k) return value;
  fail(key, fmt::format("= \"{}\" is unknown", value),
       fmt::format("choose one of: {}", fmt::join(known, ", ")));
}

namespace {

std::string values_text(std::span<const double> values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

std::string vector_text(int dimension, const std::string& unit) {
  return (dimension == 2 ? "[x, y] " : "[x, y, z] ") + unit;
}

}  // namespace

int TableReader::length_of(const std::string& key) const {
  const toml::array* array = table_.get_as<toml::array>(key);
  return array ? static_cast<int>(array->size()) : 0;
}

Vec3 TableReader::to_vector(const toml::node& node, const std::string& key, int dimension,
                            const std::string& unit) const {
  const toml::array* array = node.as_array();
  if (!array || array->size() != static_cast<std::size_t>(dimension))
    throw InputError(where(&node, key) + fmt::format(" = {} is no {} of numbers", shown(node),
                                                     dimension == 2 ? "pair" : "triple"),
                     "give " + vector_text(dimension, unit));
  Vec3 v;
  for (int a = 0; a < dimension; ++a) v[a] = to_number(*array->get(a), key, {}, unit);
  return v;
}

Vec3 TableReader::vector(const std::string& key, int dimension, const std::string& unit) {
  describe(key, "vector", unit, kRequired, "");
  const Vec3 v = to_vector(need(key, vector_text(dimension, unit)), key, dimension, unit);
  note(key, values_text({v.data(), static_cast<std::size_t>(dimension)}));
  return v;
}
Vec3 TableReader::vector_or_zero(const std::string& key, int dimension, const std::string& unit) {
  describe(key, "vector", unit, "0", "");
  const toml::node* node = find(key);
  const Vec3 v = node ? to_vector(*node, key, dimension, unit) : Vec3();
  note(key, values_text({v.data(), static_cast<std::size_t>(dimension)}));
  return v;
}

std::vector<Vec3> TableReader::vectors_or_none(const std::string& key, int dimension,
                                               const std::string& unit) {
  describe(key, "list of vectors", unit, "none", "");
  std::vector<Vec3> result;
  const toml::node* node = find(key);
  if (!node) return result;
  const toml::array* array = node->as_array();
  if (!array || array->empty() || !array->get(0)->is_array())
    fail(key, fmt::format("= {} is no list of points", shown(*node)),
         dimension == 2 ? "give [[x, y], …] " + unit : "give [[x, y, z], …] " + unit);
  for (const toml::node& point : *array) result.push_back(to_vector(point, key, dimension, unit));
  std::vector<std::string> points;
  for (const Vec3& v : result)
    points.push_back(values_text({v.data(), static_cast<std::size_t>(dimension)}));
  note(key, fmt::format("[{}]", fmt::join(points, ", ")));
  return result;
}

std::vector<double> TableReader::numbers_or(const std::string& key,
                                            const std::vector<double>& fallback,
                                            const Bounds& bounds, const std::string& unit) {
  describe(key, "number|list of numbers", unit, fmt::format("{}", fmt::join(fallback, ", ")),
           range_text(bounds));
  const toml::node* node = find(key);
  std::vector<double> values = fallback;
  if (node && !node->is_array()) {
    values = {to_number(*node, key, bounds, unit)};
  } else if (node) {
    values.clear();
    for (const auto& item : *node->as_array()) values.push_back(to_number(item, key, bounds, unit));
    if (values.empty()) fail(key, "is empty", "give a number or a list of numbers");
  }
  note(key, values_text(values));
  return values;
}

Range TableReader::range(const std::string& key, const Bounds& bounds, const std::string& unit) {
  describe(key, "number|[smallest, largest]", unit, kRequired, range_text(bounds));
  const toml::node& node = need(key, bounds_text(bounds, unit) + ", or [smallest, largest]");
  if (!node.is_array()) {
    const double value = to_number(node, key, bounds, unit);
    note(key, values_text(std::array{value, value}));
    return {value, value};
  }
  const Vec3 pair = to_vector(node, key, 2, unit);
  for (const double v : {pair.x(), pair.y()})
    if (v <= bounds.lo || v >= bounds.hi)
      fail(key, fmt::format("= {} is out of range", shown(node)),
           "give [smallest, largest], each " + bounds_text(bounds, unit));
  if (pair.x() > pair.y())
    fail(key, fmt::format("= {} is reversed", shown(node)), "give [smallest, largest]");
  note(key, values_text({pair.data(), 2}));
  return {pair.x(), pair.y()};
}

std::map<std::string, std::string> TableReader::all_as_text() {
  describe("NAME", "number|text", "", "none", "");
  std::map<std::string, std::string> result;
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    asked_.insert(name);
    if (const auto text = node.value<std::string>(); node.is_string())
      result[name] = *text;
    else if (node.is_number())
      result[name] = fmt::format("{}", *node.value<double>());
    else
      fail(name, fmt::format("= {} is neither number nor text", shown(node)),
           "a script variable is a number or a text");
    note(name, result[name]);
  }
  return result;
}

void TableReader::finish() const {
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (asked_.contains(name)) continue;
    throw InputError(where(&node, name) + " is no known key",
                     fmt::format("known here: {}", fmt::join(known_, ", ")));
  }
}

}  // namespace lbm
