// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_file.hpp"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

namespace ram_parameters {
namespace {

using testing::HasSubstr;
using testing::Not;

ParameterRow row(const std::string& key, const std::string& value) {
  ParameterRow row;
  row.key = key;
  row.value = value;
  row.text = "Text of " + key + ".";
  return row;
}

TEST(ToYaml, SectionsBecomeNestedMaps) {
  const ParameterFile file{
      "a.yaml",
      "package/node",
      "Intro.",
      {row("x", "1"), row("s/y", "2.5"), row("s/t/z", "name"), row("u/v", "3")}};
  const YAML::Node yaml = YAML::Load(toYaml(file));
  EXPECT_EQ(yaml["x"].as<int>(), 1);
  EXPECT_EQ(yaml["s"]["y"].as<double>(), 2.5);
  EXPECT_EQ(yaml["s"]["t"]["z"].as<std::string>(), "name");
  EXPECT_EQ(yaml["u"]["v"].as<int>(), 3);
}

TEST(ToYaml, LeavesExpertParametersOutButKeepsTheirNeighbours) {
  ParameterRow hidden = row("hidden", "1");
  hidden.is_expert = true;
  hidden.heading = "Tuning";
  const std::string text =
      toYaml({"a.yaml", "package/node", "Intro.", {row("x", "1"), hidden, row("y", "2")}});
  EXPECT_THAT(text, HasSubstr("x: 1"));
  EXPECT_THAT(text, HasSubstr("y: 2"));
  EXPECT_THAT(text, Not(HasSubstr("hidden:")));
  EXPECT_THAT(text, Not(HasSubstr("Tuning")));
}

TEST(ToYaml, StatesUnitAndRangeAndHeading) {
  ParameterRow speed = row("speed", "2.0");
  speed.unit = "m/s";
  speed.range = "> 0";
  speed.heading = "Motion";
  const std::string text = toYaml({"a.yaml", "package/node", "Intro.", {speed}});
  EXPECT_THAT(text, HasSubstr("package/node. Intro."));
  EXPECT_THAT(text, HasSubstr("# --- Motion"));
  EXPECT_THAT(text, HasSubstr("# Text of speed. [m/s], > 0"));
}

TEST(ToYaml, WrapsLongTextsAt120Columns) {
  ParameterRow wordy = row("x", "1");
  for (int i = 0; i < 60; ++i) wordy.text += " word";
  std::istringstream lines(toYaml({"a.yaml", "package/node", "Intro.", {wordy}}));
  std::string line;
  std::size_t longest = 0;
  while (std::getline(lines, line)) longest = std::max(longest, line.size());
  EXPECT_LE(longest, 120U);
  EXPECT_GT(longest, 100U);
}

TEST(ToMarkdown, ListsEveryRowInATable) {
  ParameterRow speed = row("speed", "2.0");
  speed.unit = "m/s";
  speed.range = "> 0";
  EXPECT_THAT(toMarkdown({"a.yaml", "package/node", "Intro.", {speed}}),
              HasSubstr("| `speed` | `2.0` | m/s | > 0 | Text of speed. |"));
}

TEST(Append, PutsTheKeysOfTheOthersInASection) {
  std::vector<ParameterRow> rows{row("x", "1")};
  append(rows, {row("y", "2")}, "s");
  append(rows, {row("z", "3")});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].key, "s/y");
  EXPECT_EQ(rows[2].key, "z");
}

}  // namespace
}  // namespace ram_parameters
