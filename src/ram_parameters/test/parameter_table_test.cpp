// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_table.hpp"

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace ram_parameters {
namespace {

using testing::HasSubstr;

enum class Colour { kRed, kGreen };

struct Inner {
  double width_m = 0.5;
  static const ParameterTable<Inner>& table() {
    static const auto table =
        ParameterTable<Inner>().add("width_m", &Inner::width_m, "m", positive(), "Of a door.");
    return table;
  }
};

struct Outer {
  int count = 3;
  int used = 2;
  bool enabled = true;
  double tiny = 1e-8;
  std::string frame = "map";
  std::vector<std::string> topics{"features"};
  Colour colour = Colour::kGreen;
  Inner inner;
  Inner nested;

  void validate() const { table().check(*this); }
  static const ParameterTable<Outer>& table() {
    using P = Outer;
    static const auto table =
        ParameterTable<P>()
            .heading("Counts")
            .add("count", &P::count, "", within(1, 10), "How many.")
            .advised(within(2, 5))
            .add("used", &P::used, "", atLeast(1), "How many are used.")
            .alias("usde")
            .rule(&P::used, "<= count", [](const P& p) { return p.used <= p.count; })
            .add("enabled", &P::enabled, "Whether at all.")
            .add("frame", &P::frame, "Its frame.")
            .rule(&P::frame, "a name", [](const P& p) { return !p.frame.empty(); })
            .add("topics", &P::topics, "Its topics.")
            .addChoice("colour", &P::colour, {{"red", Colour::kRed}, {"green", Colour::kGreen}},
                       "Its colour.")
            .include(&P::inner, Inner::table(), "loop_")
            .expert("Rarely changed")
            .add("tiny", &P::tiny, "m^2/m", positive(), "Small.")
            .advised(below(1.0), [](const P& p) { return p.enabled; })
            .section("nested", &P::nested, Inner::table());
    return table;
  }
};

Outer read(const std::string& yaml) {
  ParameterReader reader(YAML::Load(yaml), "test");
  return Outer::table().readAll(reader);
}

std::string refusal(const std::string& yaml) {
  try {
    read(yaml);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

ParameterFile file() {
  return {"outer.yaml", "package/outer", "Does something.", Outer::table().rows()};
}

TEST(ParameterTable, ReadsEveryKindOfField) {
  const Outer values = read(
      "{count: 5, used: 4, enabled: false, frame: odom, topics: [a, b], colour: red, "
      "loop_width_m: 2, tiny: 3.0e-4, nested: {width_m: 7}}");
  EXPECT_EQ(values.count, 5);
  EXPECT_EQ(values.used, 4);
  EXPECT_FALSE(values.enabled);
  EXPECT_EQ(values.frame, "odom");
  EXPECT_THAT(values.topics, testing::ElementsAre("a", "b"));
  EXPECT_EQ(values.colour, Colour::kRed);
  EXPECT_EQ(values.inner.width_m, 2.0);
  EXPECT_EQ(values.tiny, 3e-4);
  EXPECT_EQ(values.nested.width_m, 7.0);
}

TEST(ParameterTable, KeepsDefaultsOfAbsentKeys) {
  EXPECT_EQ(read("{}").count, 3);
  EXPECT_EQ(read("{}").colour, Colour::kGreen);
}

TEST(ParameterTable, RefusesValuesOutOfBoundsByTheirFullName) {
  EXPECT_THAT(refusal("{count: 11}"), HasSubstr("count must be in [1, 10], got 11"));
  EXPECT_THAT(refusal("{loop_width_m: 0}"), HasSubstr("loop_width_m must be > 0"));
  EXPECT_THAT(refusal("{nested: {width_m: -1}}"), HasSubstr("nested/width_m must be > 0"));
  EXPECT_THAT(refusal("{used: 4}"), HasSubstr("used must be <= count, got 4"));
  EXPECT_THAT(refusal("{frame: ''}"), HasSubstr("frame must be a name, got \"\""));
  EXPECT_THAT(refusal("{colour: blue}"), HasSubstr("colour must be red or green, got 'blue'"));
}

TEST(ParameterTable, RefusesUnknownKeysAlsoInSections) {
  EXPECT_THAT(refusal("{cuont: 1}"), HasSubstr("unknown parameter 'cuont'"));
  EXPECT_THAT(refusal("{nested: {widht_m: 1}}"), HasSubstr("'nested/widht_m'"));
  EXPECT_THAT(refusal("{nested: 5}"), HasSubstr("parameter 'nested' is 5, wanted a map"));
}

TEST(ParameterTable, TakesAnOlderSpellingUnlessItContradictsTheNewOne) {
  EXPECT_EQ(read("{usde: 3}").used, 3);
  EXPECT_EQ(read("{usde: 3, used: 3}").used, 3);
  EXPECT_THAT(refusal("{usde: 3, used: 1}"), HasSubstr("contradict each other"));
}

TEST(ParameterTable, WarnsOfNumbersOutsideTheRangeKnownToWork) {
  const auto warnings = [](const std::string& yaml) { return Outer::table().warnings(read(yaml)); };
  EXPECT_THAT(warnings("{}"), testing::IsEmpty());
  EXPECT_THAT(
      warnings("{count: 7}"),
      testing::ElementsAre("count = 7 is outside the range that is known to work, in [2, 5]"));
  EXPECT_THAT(warnings("{tiny: 2.0}"), testing::SizeIs(1));
  EXPECT_THAT(warnings("{tiny: 2.0, enabled: false}"), testing::IsEmpty());
}

TEST(ParameterTable, WarnsOfNumbersOfIncludedStructsByTheirFullName) {
  struct Holder {
    Outer outer;
  };
  const auto table = ParameterTable<Holder>().section("outer", &Holder::outer, Outer::table());
  Holder holder;
  holder.outer.count = 9;
  EXPECT_THAT(table.warnings(holder), testing::ElementsAre(HasSubstr("outer/count = 9")));
}

TEST(ParameterTable, DocumentsStateBothRanges) {
  EXPECT_EQ(Outer::table().rows().front().range, "in [1, 10], known to work in [2, 5]");
}

TEST(ParameterTable, ShippedFileReadsBackAsTheDefaults) {
  const std::string yaml = toYaml(file());
  const Outer values = read(yaml);
  EXPECT_EQ(Outer::table().rows(values).size(), Outer::table().rows().size());
  for (std::size_t i = 0; i < Outer::table().rows().size(); ++i)
    EXPECT_EQ(Outer::table().rows(values)[i].value, Outer::table().rows()[i].value);
  EXPECT_THAT(yaml, HasSubstr("# How many. in [1, 10], known to work in [2, 5]"));
  EXPECT_THAT(yaml, testing::Not(HasSubstr("tiny")));
}

TEST(ParameterTable, ReferenceListsExpertParametersToo) {
  EXPECT_THAT(
      toMarkdown(file()),
      HasSubstr("| `tiny` *(expert)* | `1.0e-08` | m^2/m | > 0, known to work < 1 | Small. |"));
}

TEST(ParameterTable, CheckNamesTheFirstParameterThatBreaksItsBound) {
  Outer values;
  values.count = 0;
  values.nested.width_m = -1.0;
  try {
    values.validate();
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("count must be in [1, 10], got 0"));
  }
}

TEST(ParameterTable, ReadAloneChecksNoBoundsAndLeavesUnknownKeysToOthers) {
  ParameterReader reader(YAML::Load("{count: 99, of_another_table: 1}"), "test");
  Outer values;
  Outer::table().read(reader, values);
  EXPECT_EQ(values.count, 99);
  EXPECT_THROW(Outer::table().check(values), std::invalid_argument);
}

TEST(ParameterTable, NotANumberBreaksEveryBound) {
  Outer values;
  values.tiny = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(values.validate(), std::invalid_argument);
  values.tiny = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(values.validate());  // "> 0" has no upper end
}

TEST(ParameterTable, ABoundIsCheckedBeforeTheRuleOfItsRow) {
  EXPECT_THAT(refusal("{used: 0}"), HasSubstr("used must be >= 1, got 0"));
}

TEST(ParameterTable, ADifferentTypeIsRefusedByTheNameWithItsPrefix) {
  EXPECT_THAT(refusal("{loop_width_m: wide}"),
              HasSubstr("parameter 'loop_width_m' is wide, wanted a finite number"));
  EXPECT_THAT(refusal("{nested: {width_m: [1]}}"),
              HasSubstr("parameter 'nested/width_m' is [1], wanted a finite number"));
  EXPECT_THAT(refusal("{colour: [red]}"), HasSubstr("wanted a string"));
}

TEST(ParameterTable, AnOlderSpellingMeetsTheSameBounds) {
  EXPECT_THAT(refusal("{usde: 0}"), HasSubstr("used must be >= 1, got 0"));
  EXPECT_THAT(refusal("{usde: 1.5}"), HasSubstr("parameter 'usde' is 1.5, wanted an integer"));
  EXPECT_EQ(refusal("{usde: 3, used: 1}"),
            "used = 1 and usde = 3 contradict each other: keep the first");
}

TEST(ParameterTable, AnOlderSpellingLeavesTheOtherFieldsAsTheyWereRead) {
  const Outer values = read("{count: 9, usde: 7, frame: odom}");
  EXPECT_EQ(values.count, 9);
  EXPECT_EQ(values.used, 7);
  EXPECT_EQ(values.frame, "odom");
}

TEST(ParameterTable, RowsAreInTheOrderOfTheTableWithTheirFullKeys) {
  std::vector<std::string> keys;
  for (const ParameterRow& row : Outer::table().rows()) keys.push_back(row.key);
  EXPECT_THAT(keys, testing::ElementsAre("count", "used", "enabled", "frame", "topics", "colour",
                                         "loop_width_m", "tiny", "nested/width_m"));
}

TEST(ParameterTable, RowsOfASectionForExpertsAreForExperts) {
  const std::vector<ParameterRow> rows = Outer::table().rows();
  EXPECT_FALSE(rows[6].is_expert);  // loop_width_m, included before
  EXPECT_TRUE(rows[7].is_expert);
  EXPECT_TRUE(rows[8].is_expert);
  EXPECT_EQ(rows[7].heading, "Rarely changed");
  EXPECT_EQ(rows[8].heading, "");
}

TEST(ParameterTable, RowsHaveTheValuesOfTheStructTheyAreAskedFor) {
  Outer values;
  values.topics = {"a", "b"};
  values.colour = Colour::kRed;
  values.enabled = false;
  const std::vector<ParameterRow> rows = Outer::table().rows(values);
  EXPECT_EQ(rows[2].value, "false");
  EXPECT_EQ(rows[4].value, "[a, b]");
  EXPECT_EQ(rows[5].value, "red");
  EXPECT_EQ(rows[5].range, "red or green");
}

TEST(ParameterTable, AHeadingBeforeAnIncludedStructGoesToItsFirstRow) {
  struct Holder {
    Outer outer;
  };
  const auto table = ParameterTable<Holder>()
                         .heading("All of it")
                         .section("outer", &Holder::outer, Outer::table());
  const std::vector<ParameterRow> rows = table.rows();
  EXPECT_EQ(rows.front().key, "outer/count");
  EXPECT_EQ(rows.front().heading, "All of it");
  EXPECT_EQ(rows.back().key, "outer/nested/width_m");
  ParameterReader reader(YAML::Load("{outer: {nested: {width_m: 4}, usde: 3}}"), "test");
  Holder holder;
  table.read(reader, holder);
  EXPECT_EQ(holder.outer.nested.width_m, 4.0);
}

TEST(ParameterTable, AnOlderSpellingWithinASectionIsAKeyOfTheWholeFile) {
  struct Holder {
    Outer outer;
  };
  const auto table = ParameterTable<Holder>().section("outer", &Holder::outer, Outer::table());
  ParameterReader reader(YAML::Load("{usde: 1}"), "test");
  Holder holder;
  table.read(reader, holder);
  reader.rejectUnknown();
  EXPECT_EQ(holder.outer.used, 1);
}

}  // namespace
}  // namespace ram_parameters
