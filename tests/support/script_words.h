// SPDX-License-Identifier: GPL-2.0-or-later
/// How LIGGGHTS reads a line of a script in which ${v} stands: it puts the value in as text, cuts a
/// comment off, and looks for words and quotes, in a quoted command once more.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace test {

/// A line with the value in every place of ${v}.
inline std::string filled(std::string line, const std::string& value) {
  const std::string use = "${v}";
  for (std::size_t at = 0; (at = line.find(use, at)) != std::string::npos; at += value.size())
    line.replace(at, use.size(), value);
  return line;
}

/// The words of a line, those of quoted commands with them. Nothing where a quote stays open, the
/// line goes on (&), or something is left that is put in or carried out once more ($, `).
inline std::optional<std::vector<std::string>> script_words(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  bool any = false;
  const auto end_word = [&] {
    if (any) words.push_back(word);
    word.clear();
    any = false;
  };
  for (std::size_t i = 0; i < line.size() && line[i] != '#'; ++i) {
    const char c = line[i];
    if (c == '$' || c == '`' || c == '\n' || c == '\r' || c == '&' || c == '\0')
      return std::nullopt;
    if (c == '"' || c == '\'') {
      const std::size_t close = line.find(c, i + 1);
      if (close == std::string::npos) return std::nullopt;
      const auto inner = script_words(line.substr(i + 1, close - i - 1));
      if (!inner) return std::nullopt;
      end_word();
      words.emplace_back(1, c);
      words.insert(words.end(), inner->begin(), inner->end());
      words.emplace_back(1, c);
      i = close;
    } else if (c == ' ' || c == '\t' || c == '\v' || c == '\f') {
      end_word();
    } else {
      any = true;
      word += c;
    }
  }
  end_word();
  return words;
}

/// Lines as scripts have them, with a value of the scene in each place.
inline constexpr std::array kScriptLines{
    "variable a equal 2*${v}",
    "fix breaks all bond/breaks every ${v}00 file ${v}.csv",
    "fix kn all property/global kn peratomtypepair 1 ${v}",
    "include common/${v}.liggghts",
    "fix told all print 20 \"time ${v}\" append told.csv screen no",
    "if \"${v} == 1\" then \"fix a all nve/${v}\" else \"print 'no ${v}' append ${v}\"",
    "print \"a ${v}\" file ${v}"};

/// A value leaves every line with the words that it had, and stands as a part of one.
inline bool is_one_word_in_scripts(const std::string& value) {
  for (const std::string line : kScriptLines) {
    auto expected = script_words(filled(line, "WORD"));
    for (std::string& word : *expected)
      for (std::size_t at = 0; (at = word.find("WORD", at)) != std::string::npos;
           at += value.size())
        word.replace(at, 4, value);
    if (script_words(filled(line, value)) != expected) return false;
  }
  return true;
}

/// The path of a folder between quotes is one word, but for its blanks.
inline bool is_whole_between_quotes(const std::string& path) {
  const auto words = script_words("read_restart \"" + path + "\"");
  return words && (*words)[1] == "\"" && words->back() == "\"" &&
         std::count(words->begin(), words->end(), "\"") == 2 &&
         std::count(words->begin(), words->end(), "'") == 0;
}

}  // namespace test
