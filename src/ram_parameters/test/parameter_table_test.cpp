// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_table.hpp"

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

}  // namespace
}  // namespace ram_parameters
