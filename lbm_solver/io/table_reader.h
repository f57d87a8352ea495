// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <toml++/impl/forward_declarations.h>  // the whole takes seconds to compile

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// Bounds of a number, both inclusive unless `exclusive`.
struct Bounds {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();
  bool exclusive = false;

  static Bounds positive() { return {0.0, std::numeric_limits<double>::infinity(), true}; }
  static Bounds non_negative() { return {0.0}; }
};

/// What the reader knows of a key: how `lbm --keys` lists it.
struct KeyNote {
  std::string key;  ///< full name; of a list of tables without a number
  std::string type, unit, fallback, range;
};

/// The keys that a reader asked for, each once, in the order in which it first did.
class KeyNotes {
 public:
  /// A key that is asked for again, in another dimension, say, adds what else it may be.
  void add(const KeyNote& note);
  const std::vector<KeyNote>& all() const { return notes_; }

 private:
  std::vector<KeyNote> notes_;
};

/// One table of a scene file. Every getter notes its key; `finish` complains about keys that nobody
/// asked for. All errors are InputError and name file, line, key, value and remedy.
class TableReader {
 public:
  /// @param settings  gets every value that is asked for, defaults too, under its full key
  /// @param keys      gets every key that is asked for, with its type, unit, default and range
  TableReader(const toml::table& table, std::string path, std::string file,
              std::map<std::string, std::string>* settings = nullptr, KeyNotes* keys = nullptr);

  /// Puts a value among the settings that is no key of the table.
  void note(const std::string& key, const std::string& value) const;

  bool has(const std::string& key);
  TableReader table(const std::string& key);
  /// A table that may be absent: then an empty one.
  TableReader optional_table(const std::string& key);

  /// Every table of an array [[key]]; none where it is absent.
  std::vector<TableReader> tables(const std::string& key);

  double number(const std::string& key, const Bounds& bounds, const std::string& unit);
  double number_or(const std::string& key, double fallback, const Bounds& bounds,
                   const std::string& unit);
  std::optional<double> optional_number(const std::string& key, const Bounds& bounds,
                                        const std::string& unit);
  std::optional<int> optional_integer(const std::string& key, int least);
  bool flag_or(const std::string& key, bool fallback);
  std::string text_or(const std::string& key, const std::string& fallback);
  std::string choice_or(const std::string& key, const std::string& fallback,
                        const std::vector<std::string>& known);
  /// Numbers in a list; 0 where the key is absent or no list.
  int length_of(const std::string& key) const;
  /// A vector of 2 or 3 numbers.
  Vec3 vector(const std::string& key, int dimension, const std::string& unit);
  Vec3 vector_or_zero(const std::string& key, int dimension, const std::string& unit);
  std::vector<Vec3> vectors_or_none(const std::string& key, int dimension, const std::string& unit);
  /// A number, or a list of numbers.
  std::vector<double> numbers_or(const std::string& key, const std::vector<double>& fallback,
                                 const Bounds& bounds, const std::string& unit);
  /// A number, or [smallest, largest].
  Range range(const std::string& key, const Bounds& bounds, const std::string& unit);
  /// Every key of the table as text; numbers as the shortest text that reads back the same.
  std::map<std::string, std::string> all_as_text();

  /// @throws InputError for a key that was not asked for
  void finish() const;

  /// Where the table stands: file and line.
  std::string place() const;

  [[noreturn]] void fail(const std::string& key, const std::string& problem,
                         const std::string& remedy) const;

 private:
  const toml::node* find(const std::string& key);
  std::string text(const std::string& key, const std::string& fallback);
  std::string full(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  void describe(const std::string& key, const std::string& type, const std::string& unit,
                const std::string& fallback, const std::string& range) const;
  /// What stands in the table in place of a key that is missing.
  std::string misspelt(const std::string& key) const;
  const toml::node& need(const std::string& key, const std::string& what);
  std::string place(const toml::node& node) const;
  std::string where(const toml::node* node, const std::string& key) const;
  double to_number(const toml::node& node, const std::string& key, const Bounds& bounds,
                   const std::string& unit) const;
  Vec3 to_vector(const toml::node& node, const std::string& key, int dimension,
                 const std::string& unit) const;

  const toml::table& table_;
  std::string path_, file_;
  std::string name_;  // path_, of a table of a list with its number from 1
  std::map<std::string, std::string>* settings_;
  KeyNotes* keys_;
  std::set<std::string> asked_;  // keys whose values were wanted
  std::set<std::string> known_;  // also those that were only looked for
};

}  // namespace lbm
