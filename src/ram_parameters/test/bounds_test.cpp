// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/bounds.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace ram_parameters {
namespace {

TEST(Bounds, EachEndIsIncludedOrNot) {
  EXPECT_FALSE(positive().contain(0.0));
  EXPECT_TRUE(positive().contain(1e-300));
  EXPECT_TRUE(atLeast(0.0).contain(0.0));
  EXPECT_FALSE(below(1.0).contain(1.0));
  EXPECT_TRUE(within(1.0, 2.0).contain(1.0));
  EXPECT_TRUE(within(1.0, 2.0).contain(2.0));
  EXPECT_FALSE(between(1.0, 2.0).contain(1.0));
  EXPECT_FALSE(between(1.0, 2.0).contain(2.0));
  EXPECT_FALSE(aboveUpTo(1.0, 2.0).contain(1.0));
  EXPECT_TRUE(aboveUpTo(1.0, 2.0).contain(2.0));
}

TEST(Bounds, ContainNoNotANumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Bounds& bounds : {anyNumber(), positive(), atLeast(0.0), below(1.0), within(0, 1)})
    EXPECT_FALSE(bounds.contain(nan)) << bounds.text();
}

TEST(Bounds, TextStatesTheIntervalAsErrorsDo) {
  EXPECT_EQ(anyNumber().text(), "");
  EXPECT_EQ(positive().text(), "> 0");
  EXPECT_EQ(atLeast(1.5).text(), ">= 1.5");
  EXPECT_EQ(below(0.25).text(), "< 0.25");
  EXPECT_EQ(within(-1.0, 1.0).text(), "in [-1, 1]");
  EXPECT_EQ(between(0.0, 1.0).text(), "in (0, 1)");
  EXPECT_EQ(aboveUpTo(0.0, 3600.0).text(), "in (0, 3600]");
}

TEST(ToYamlText, NumbersReadBackAsTheSameAndHaveAPoint) {
  for (const double value : {0.0, 1.0, -2.5, 0.1, 1e-8, 1.0 / 3.0, 123456789.0, 6.02e23}) {
    const std::string text = toYamlText(value);
    EXPECT_EQ(YAML::Load(text).as<double>(), value) << text;
    EXPECT_NE(text.find('.'), std::string::npos) << text;
  }
  EXPECT_EQ(toYamlText(3), "3");
  EXPECT_EQ(toPlainText(3.0), "3");
}

TEST(ToYamlText, TextIsQuotedWhereYamlWouldTakeItForSomethingElse) {
  EXPECT_EQ(toYamlText(std::string("base_link")), "base_link");
  for (const std::string text : {"", "1", "a: b", "#x", "-", "[a]", "a, b"}) {
    EXPECT_EQ(YAML::Load("key: " + toYamlText(text))["key"].as<std::string>(), text);
    EXPECT_EQ(toYamlText(text).front(), '"') << text;
  }
}

TEST(ToYamlText, WordsThatYamlTakesForTruthValuesOrNothingAreQuoted) {
  for (const std::string word : {"true", "False", "yes", "NO", "on", "Off", "y", "N", "null"})
    EXPECT_EQ(toYamlText(word), '"' + word + '"');
  EXPECT_EQ(toYamlText(std::string("north")), "north");
}

TEST(ToYamlText, QuotesAndBackslashesReadBackAsTheyWere) {
  for (const std::string text : {"a \"b\"", "C:\\maps", "a\\b", "\""})
    EXPECT_EQ(YAML::Load("key: " + toYamlText(text))["key"].as<std::string>(), text);
}

TEST(ToYamlText, ListsReadBackElementByElement) {
  EXPECT_EQ(YAML::Load(toYamlText(std::vector<double>{0.1, 2.0})).as<std::vector<double>>(),
            (std::vector<double>{0.1, 2.0}));
  EXPECT_EQ(toYamlText(std::vector<std::string>{"a", "b c"}), "[a, \"b c\"]");
  EXPECT_EQ(toYamlText(std::vector<double>{}), "[]");
}

TEST(Bounds, OfEveryFactoryMatchTheIntervalThatTheirTextStates) {
  // The text is parsed again and compared with contain(): an independent reading of the interval.
  for (const Bounds& bounds : {positive(), above(-2.0), atLeast(-1.5), below(0.25),
                               within(-1.0, 1.0), between(-1.0, 1.0), aboveUpTo(-1.0, 1.0)}) {
    const std::string text = bounds.text();
    for (const double value : {-3.0, -2.0, -1.5, -1.0, -0.5, 0.0, 0.25, 0.5, 1.0, 7.0}) {
      bool stated = false;
      if (text.compare(0, 3, ">= ") == 0) {
        stated = value >= std::stod(text.substr(3));
      } else if (text.compare(0, 2, "> ") == 0) {
        stated = value > std::stod(text.substr(2));
      } else if (text.compare(0, 2, "< ") == 0) {
        stated = value < std::stod(text.substr(2));
      } else {
        ASSERT_EQ(text.compare(0, 3, "in "), 0) << text;
        const double lowest = std::stod(text.substr(4));
        const double highest = std::stod(text.substr(text.find(',') + 1));
        stated = (text[3] == '[' ? value >= lowest : value > lowest) &&
                 (text.back() == ']' ? value <= highest : value < highest);
      }
      EXPECT_EQ(bounds.contain(value), stated) << value << " " << text;
    }
  }
}

TEST(Bounds, InfinityIsInWhatHasNoEndOnThatSide) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(positive().contain(infinity));
  EXPECT_FALSE(positive().contain(-infinity));
  EXPECT_TRUE(below(0.0).contain(-infinity));
  EXPECT_FALSE(within(0.0, 1e308).contain(infinity));
}

TEST(ToYamlText, TextIsTheShortestThatReadsBack) {
  EXPECT_EQ(toYamlText(0.1), "0.1");
  EXPECT_EQ(toYamlText(1e-8), "1.0e-08");
  EXPECT_EQ(toYamlText(1e22), "1.0e+22");
  EXPECT_EQ(toYamlText(-2.0), "-2.0");
  EXPECT_EQ(toPlainText(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(toYamlText(true), "true");
  EXPECT_EQ(toYamlText(-7), "-7");
}

TEST(ToYamlText, NumbersOfManyMagnitudesReadBackToTheLastBit) {
  double value = 4.9e-300;
  for (int i = 0; i < 400; ++i) {
    EXPECT_EQ(YAML::Load(toYamlText(value)).as<double>(), value) << toYamlText(value);
    value *= -31.4159265358979;
    if (std::abs(value) > 1e300) break;
  }
}

}  // namespace
}  // namespace ram_parameters
