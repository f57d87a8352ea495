// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/choices.h"

#include <gtest/gtest.h>

#include <set>

namespace {

using namespace lbm;

template <class E>
class ChoiceTest : public testing::Test {};
using All = testing::Types<VelocitySet, CollisionOperator, SolidTerm, SolidScheme, WeightRule,
                           Precision, EddyModel>;
TYPED_TEST_SUITE(ChoiceTest, All);

TYPED_TEST(ChoiceTest, HasANameOfItsOwnForEachValue) {
  std::set<std::string> names;
  int last = -1;
  for (const auto& [value, name] : ChoiceNames<TypeParam>::table) {
    EXPECT_EQ(static_cast<int>(value), ++last) << name;
    EXPECT_EQ(name_of(value), name);
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  for (const TypeParam value : choices<TypeParam>())
    EXPECT_EQ(from_name<TypeParam>(name_of(value)), value);
}

TYPED_TEST(ChoiceTest, NamesTheKnownOnesWhereANameIsNone) {
  try {
    from_name<TypeParam>("ladd");
    FAIL();
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("'ladd'"), std::string::npos) << text;
    for (const TypeParam value : choices<TypeParam>())
      EXPECT_NE(text.find(" " + name_of(value)), std::string::npos) << text;
  }
}

TEST(Choices, OfASolidTermLeaveOutNone) {
  EXPECT_EQ(name_of(SolidTerm::None), "none");
  EXPECT_EQ(choices<SolidTerm>().front(), SolidTerm::Resistance);
  EXPECT_THROW(from_name<SolidTerm>("none"), std::invalid_argument);
}

}  // namespace
