// SPDX-License-Identifier: GPL-2.0-or-later
/// Every getter of a table: what it takes, what it says of a mistake, and what is noted.
#include "lbm_solver/io/table_reader.h"

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <functional>

#include "lbm_solver/base/errors.h"

namespace {

using namespace lbm;

/// A table [t] of a scene, read by `read`.
template <class Read>
auto with(const std::string& text, Read&& read, std::map<std::string, std::string>* noted = {}) {
  const toml::table table = toml::parse(text, std::string("s.toml"));
  TableReader root(table, "", "s.toml", noted);
  TableReader t = root.table("t");
  return read(t);
}

struct Mistake {
  const char* text;  ///< of the table
  std::function<void(TableReader&)> read;
  std::vector<const char*> words;
};

TEST(TableReader, NamesFileLineKeyValueAndRemedy) {
  const Bounds positive = Bounds::positive();
  const std::vector<Mistake> mistakes{
      {"x = -1.5",
       [&](auto& t) { t.number("x", positive, "m"); },
       {"s.toml:2: t.x", "= -1.5 is out of range", "give a positive number [m]"}},
      {"x = nan", [&](auto& t) { t.number("x", {}, "m"); }, {"is out of range", "give a number m"}},
      {"x = inf", [&](auto& t) { t.number_or("x", 1.0, {}, ""); }, {"is out of range"}},
      {"x = \"1\"",
       [&](auto& t) {
         t.number_or("x", 1.0, {0.0, 2.0}, "");
       },
       {"= '1' is not a number", "give a number from 0 to 2"}},
      {"x = 3",
       [&](auto& t) {
         t.optional_number("x", {0.0, 2.0}, "");
       },
       {"is out of range"}},
      {"dx = 1",
       [&](auto& t) { t.number("x", positive, "m"); },
       {"t.x is missing, but there is 'dx'", "give a positive number [m]"}},
      {"x = 1.5",
       [&](auto& t) { t.optional_integer("x", 2); },
       {"= 1.5 must be an integer ≥ 2", "give a whole number from 2"}},
      {"x = 1", [&](auto& t) { t.optional_integer("x", 2); }, {"= 1 must be an integer ≥ 2"}},
      {"x = 2000000000", [&](auto& t) { t.optional_integer("x", 2); }, {"must be an integer"}},
      {"x = 1", [&](auto& t) { t.flag_or("x", true); }, {"= 1 is neither true nor false"}},
      {"x = 1", [&](auto& t) { t.text_or("x", ""); }, {"= 1 is no text", "quotation marks"}},
      {"x = \"c\"",
       [&](auto& t) {
         t.choice_or("x", "a", {"a", "b"});
       },
       {"= \"c\" is unknown", "choose one of: a, b"}},
      {"x = [1, 2, 3]",
       [&](auto& t) { t.vector("x", 2, "[m]"); },
       {"= [1, 2, 3] is no pair of numbers", "give [x, y] [m]"}},
      {"x = [1, \"a\"]", [&](auto& t) { t.vector("x", 2, "[m]"); }, {"is not a number"}},
      {"x = 1",
       [&](auto& t) { t.vector_or_zero("x", 3, "[m]"); },
       {"is no triple of numbers", "give [x, y, z] [m]"}},
      {"x = [1, 2]",
       [&](auto& t) { t.vectors_or_none("x", 2, "[m]"); },
       {"is no list of points", "give [[x, y], …] [m]"}},
      {"x = []",
       [&](auto& t) { t.numbers_or("x", {1.0}, {}, ""); },
       {"is empty", "give a number or a list of numbers"}},
      {"x = [1, 5]",
       [&](auto& t) {
         t.numbers_or("x", {1.0}, {0.0, 2.0}, "");
       },
       {"is out of range"}},
      {"x = [2, 1]",
       [&](auto& t) { t.range("x", positive, "m"); },
       {"is reversed", "give [smallest, largest]"}},
      {"x = [0, 1]", [&](auto& t) { t.range("x", positive, "m"); }, {"is out of range"}},
      {"x = [1]", [&](auto& t) { t.all_as_text(); }, {"is neither number nor text"}},
      {"x = 1", [&](auto& t) { t.table("x"); }, {"= 1 is no table", "write [x]"}},
      {"x = 1", [&](auto& t) { t.tables("x"); }, {"is no list of tables", "write [[x]]"}},
      {"x = 1\ny = 2",
       [&](auto& t) {
         t.number("x", {}, "");
         t.finish();
       },
       {"s.toml:3: t.y is no known key", "known here: x"}}};
  for (const Mistake& m : mistakes) try {
      with(std::string("[t]\n") + m.text, [&](TableReader& t) {
        m.read(t);
        return 0;
      });
      ADD_FAILURE() << m.text << " was taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.exit_code(), protocol::kBadInput);
      for (const char* words : m.words)
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos)
            << m.text << ": " << error.what();
    }
}

TEST(TableReader, ReadsWhatIsThereAndTakesDefaultsElse) {
  std::map<std::string, std::string> noted;
  with(R"([t]
number = 2.5
whole = 3
flag = false
text = "words"
vector = [1, 2]
points = [[1, 2], [3, 4]]
list = [0.5, 1]
one = 0.5
range = [1, 2]
[[t.each]]
a = 1
[[t.each]]
a = 2
)",
       [](TableReader& t) {
         EXPECT_EQ(t.number("number", Bounds::positive(), "m"), 2.5);
         EXPECT_EQ(t.number_or("absent", 7.0, {}, ""), 7.0);
         EXPECT_FALSE(t.optional_number("absent2", {}, "").has_value());
         EXPECT_EQ(t.optional_integer("whole", 1), 3);
         EXPECT_FALSE(t.flag_or("flag", true));
         EXPECT_EQ(t.choice_or("text", "a", {"a", "words"}), "words");
         EXPECT_EQ(t.length_of("vector"), 2);
         EXPECT_EQ(t.length_of("number"), 0);
         EXPECT_EQ(t.vector("vector", 2, ""), Vec3(1.0, 2.0, 0.0));
         EXPECT_EQ(t.vector_or_zero("absent3", 3, ""), Vec3());
         EXPECT_EQ(t.vectors_or_none("points", 2, "").at(1), Vec3(3.0, 4.0, 0.0));
         EXPECT_EQ(t.numbers_or("list", {}, {}, ""), (std::vector{0.5, 1.0}));
         EXPECT_EQ(t.numbers_or("one", {}, {}, ""), (std::vector{0.5}));
         EXPECT_EQ(t.range("range", Bounds::positive(), "").hi, 2.0);
         int sum = 0;
         for (TableReader& each : t.tables("each")) sum += *each.optional_integer("a", 1);
         EXPECT_EQ(sum, 3);
         EXPECT_TRUE(t.tables("absent4").empty());
         EXPECT_FALSE(t.optional_table("absent5").has("x"));
         t.finish();
         return 0;
       },
       &noted);
  EXPECT_EQ(noted.at("t.number"), "2.5");
  EXPECT_EQ(noted.at("t.absent"), "7");  // defaults too
  EXPECT_EQ(noted.at("t.points"), "[[1, 2], [3, 4]]");
  EXPECT_EQ(noted.count("t.absent2"), 0U);  // it has none
}

}  // namespace
