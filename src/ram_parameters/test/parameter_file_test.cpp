// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_file.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

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

TEST(ToYaml, AShortFileIsWrittenToTheLetter) {
  ParameterRow width = row("door/width_m", "0.9");
  width.unit = "m";
  width.range = "> 0";
  width.text = "Of a door";
  ParameterRow plain = row("frame", "map");
  plain.text = "";
  EXPECT_EQ(
      toYaml({"a.yaml", "package/node", "Intro.", {plain, width}}),
      "# Parameters of package/node. Intro.\n"
      "# Made from the tables in the code by `make parameters`; docs/parameters.md lists these "
      "and the parameters for experts.\n"
      "\n"
      "frame: map\n"
      "\n"
      "door:\n"
      "  width_m: 0.9                          # Of a door [m], > 0\n");
}

TEST(ToYaml, ARowWithUnitOnlyOrRangeOnlyHasThatAsItsComment) {
  ParameterRow unit = row("a", "1");
  unit.text = "";
  unit.unit = "m";
  ParameterRow range = row("b", "1");
  range.text = "";
  range.range = ">= 1";
  const std::string text = toYaml({"a.yaml", "package/node", "Intro.", {unit, range}});
  EXPECT_THAT(text, HasSubstr(" # [m]\n"));
  EXPECT_THAT(text, HasSubstr(" # >= 1\n"));
}

TEST(ToYaml, ASectionThatWasLeftIsNotOpenedAgainForItsInnerSections) {
  const std::string text = toYaml({"a.yaml",
                                   "package/node",
                                   "Intro.",
                                   {row("s/a/x", "1"), row("s/b/x", "2"), row("t/a/x", "3")}});
  const YAML::Node yaml = YAML::Load(text);
  EXPECT_EQ(yaml["s"].size(), 2U);
  EXPECT_EQ(yaml["s"]["b"]["x"].as<int>(), 2);
  EXPECT_EQ(yaml["t"]["a"]["x"].as<int>(), 3);
  std::size_t count = 0;
  for (std::size_t at = text.find("\ns:"); at != std::string::npos; at = text.find("\ns:", at + 1))
    ++count;
  EXPECT_EQ(count, 1U);
}

TEST(ToYaml, ASectionWhoseNameBeginsLikeAnotherIsOneOfItsOwn) {
  const YAML::Node yaml = YAML::Load(toYaml(
      {"a.yaml", "package/node", "Intro.", {row("loop/x", "1"), row("loop_search/x", "2")}}));
  EXPECT_EQ(yaml["loop"]["x"].as<int>(), 1);
  EXPECT_EQ(yaml["loop_search"]["x"].as<int>(), 2);
}

TEST(ToYaml, AHeadingOfAnExpertRowIsNotGivenToTheNextGroup) {
  ParameterRow hidden = row("hidden", "1");
  hidden.is_expert = true;
  hidden.heading = "Tuning";
  ParameterRow shown = row("shown", "2");
  shown.heading = "Use";
  const std::string text = toYaml({"a.yaml", "package/node", "Intro.", {hidden, shown}});
  EXPECT_THAT(text, HasSubstr("# --- Use\n"));
  EXPECT_THAT(text, Not(HasSubstr("Tuning")));
}

TEST(ToYaml, OfNoRowsIsAnEmptyMapWithItsIntroduction) {
  const std::string text = toYaml({"a.yaml", "package/node", "Does nothing.", {}});
  EXPECT_THAT(text, HasSubstr("# Parameters of package/node. Does nothing.\n"));
  EXPECT_TRUE(YAML::Load(text).IsNull());
}

TEST(ToYaml, LongTextsStandAboveTheirLineWithItsIndent) {
  ParameterRow wordy = row("s/x", "1");
  for (int i = 0; i < 40; ++i) wordy.text += " word" + std::to_string(i);
  std::istringstream lines(toYaml({"a.yaml", "package/node", "Intro.", {wordy}}));
  std::vector<std::string> comments;
  std::string line;
  while (std::getline(lines, line) && line != "  x: 1")
    if (line.compare(0, 4, "  # ") == 0) comments.push_back(line.substr(4));
  EXPECT_EQ(line, "  x: 1");
  ASSERT_GT(comments.size(), 1U);
  std::string joined;
  for (const std::string& comment : comments) joined += (joined.empty() ? "" : " ") + comment;
  EXPECT_EQ(joined, wordy.text);
}

TEST(ToMarkdown, NamesNodeAndFileAndPutsHeadingsBetweenRows) {
  ParameterRow hidden = row("s/tiny", "1.0e-08");
  hidden.heading = "Tuning";
  hidden.is_expert = true;
  EXPECT_EQ(toMarkdown({"a.yaml", "package/node", "Intro.", {row("x", "1"), hidden}}),
            "## package/node\n\n"
            "Intro. Shipped as `config/a.yaml`.\n\n"
            "| parameter | default | unit | range | what it decides |\n|---|---|---|---|---|\n"
            "| `x` | `1` |  |  | Text of x. |\n"
            "| **Tuning** | | | | |\n"
            "| `s/tiny` *(expert)* | `1.0e-08` |  |  | Text of s/tiny. |\n");
}

}  // namespace
}  // namespace ram_parameters
