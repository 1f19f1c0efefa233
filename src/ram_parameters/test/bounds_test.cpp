// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/bounds.hpp"

#include <limits>

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

TEST(ToYamlText, ListsReadBackElementByElement) {
  EXPECT_EQ(YAML::Load(toYamlText(std::vector<double>{0.1, 2.0})).as<std::vector<double>>(),
            (std::vector<double>{0.1, 2.0}));
  EXPECT_EQ(toYamlText(std::vector<std::string>{"a", "b c"}), "[a, \"b c\"]");
  EXPECT_EQ(toYamlText(std::vector<double>{}), "[]");
}

}  // namespace
}  // namespace ram_parameters
