// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_reader.hpp"

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ram_parameters {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ParameterReader readerOf(const std::string& yaml) {
  return ParameterReader(YAML::Load(yaml), "/node");
}

template <typename Action>
std::string messageOf(const Action& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ParameterReader, ReadsEveryType) {
  ParameterReader reader = readerOf("{b: true, i: 3, d: 2.5, s: text, l: [1, 2.5], n: [a, b]}");
  bool b = false;
  int i = 0;
  double d = 0.0;
  std::string s;
  std::vector<double> l;
  std::vector<std::string> n;
  reader.read("b", b);
  reader.read("i", i);
  reader.read("d", d);
  reader.read("s", s);
  reader.read("l", l);
  reader.read("n", n);
  reader.rejectUnknown();
  EXPECT_TRUE(b);
  EXPECT_EQ(i, 3);
  EXPECT_EQ(d, 2.5);
  EXPECT_EQ(s, "text");
  EXPECT_THAT(l, ElementsAre(1.0, 2.5));
  EXPECT_THAT(n, ElementsAre("a", "b"));
}

TEST(ParameterReader, AbsentKeyKeepsTheDefault) {
  for (const char* yaml : {"{}", "", "{other: 1}"}) {
    ParameterReader reader = readerOf(yaml);
    double value = 0.25;
    reader.read("value", value);
    EXPECT_EQ(value, 0.25);
  }
}

TEST(ParameterReader, IntegerIsADouble) {
  ParameterReader reader = readerOf("{d: 2}");
  double d = 0.0;
  reader.read("d", d);
  EXPECT_EQ(d, 2.0);
}

TEST(ParameterReader, RefusesWrongTypesAndSaysWhat) {
  for (const char* yaml :
       {"{k: 0.5}", "{k: '3'}", "{k: text}", "{k: [1]}", "{k: {a: 1}}", "{k: .nan}", "{k: 1e12}"}) {
    ParameterReader reader = readerOf(yaml);
    int value = 0;
    EXPECT_THAT(
        messageOf([&] { reader.read("k", value); }),
        testing::AllOf(HasSubstr("/node: parameter 'k' is"), HasSubstr("wanted an integer")))
        << yaml;
  }
  for (const char* yaml : {"{k: '0.5'}", "{k: .inf}", "{k: true}"}) {
    ParameterReader reader = readerOf(yaml);
    double value = 0.0;
    EXPECT_THAT(messageOf([&] { reader.read("k", value); }), HasSubstr("wanted a finite number"))
        << yaml;
  }
}

TEST(ParameterReader, NamesAnUnknownKeyAndTheNearestKnownOne) {
  ParameterReader reader = readerOf("{particle_amuont: 5}");
  int particles = 0;
  double other = 0.0;
  reader.read("future_interpol", other);
  reader.read("particle_amount", particles);
  EXPECT_THAT(messageOf([&] { reader.rejectUnknown(); }),
              testing::AllOf(HasSubstr("'particle_amuont'"), HasSubstr("'particle_amount'")));
}

TEST(ParameterReader, ReadsASection) {
  ParameterReader reader = readerOf("{noise: {sigma_m: 0.1, oops: 1}}");
  ParameterReader noise = reader.section("noise");
  double sigma_m = 0.0;
  noise.read("sigma_m", sigma_m);
  reader.rejectUnknown();
  EXPECT_EQ(sigma_m, 0.1);
  EXPECT_THAT(messageOf([&] { noise.rejectUnknown(); }),
              HasSubstr("/node/noise: unknown parameter 'oops'"));
}

TEST(ParameterReader, RefusesWhatIsNotAMap) {
  EXPECT_THROW(readerOf("[1, 2]"), std::invalid_argument);
  EXPECT_THROW(readYamlFile("/does/not/exist.yaml"), std::runtime_error);
}

TEST(ParameterReader, RefusesEachTypeByKeyValueAndWhatWasWanted) {
  const auto refusalOf = [](const std::string& yaml, auto value) {
    ParameterReader reader = readerOf(yaml);
    return messageOf([&] { reader.read("k", value); });
  };
  EXPECT_EQ(refusalOf("{k: 3}", true), "/node: parameter 'k' is 3, wanted true or false");
  EXPECT_EQ(refusalOf("{k: 0.5}", 1), "/node: parameter 'k' is 0.5, wanted an integer");
  EXPECT_EQ(refusalOf("{k: text}", 1.0), "/node: parameter 'k' is text, wanted a finite number");
  EXPECT_EQ(refusalOf("{k: [a, b]}", std::string()),
            "/node: parameter 'k' is [a, b], wanted a string");
  EXPECT_EQ(refusalOf("{k: [1, x]}", std::vector<double>()),
            "/node: parameter 'k' is [1, x], wanted a list of finite numbers");
  EXPECT_EQ(refusalOf("{k: 7}", std::vector<double>()),
            "/node: parameter 'k' is 7, wanted a list of finite numbers");
  EXPECT_EQ(refusalOf("{k: [[a], b]}", std::vector<std::string>()),
            "/node: parameter 'k' is [[a], b], wanted a list of strings");
  EXPECT_EQ(refusalOf("{k: a}", std::vector<std::string>()),
            "/node: parameter 'k' is a, wanted a list of strings");
}

TEST(ParameterReader, ARefusedListLeavesTheOldOneAsItWas) {
  ParameterReader reader = readerOf("{k: [1, 2, .nan]}");
  std::vector<double> values{7.0};
  EXPECT_THROW(reader.read("k", values), std::invalid_argument);
  EXPECT_THAT(values, ElementsAre(7.0));
}

TEST(ParameterReader, TheLargestAndSmallestIntegersPassAndTheNextDoNot) {
  for (const int limit : {2147483647, -2147483647}) {
    ParameterReader reader = readerOf("{k: " + std::to_string(limit) + "}");
    int value = 0;
    reader.read("k", value);
    EXPECT_EQ(value, limit);
  }
  for (const char* yaml : {"{k: 2147483648}", "{k: -2147483649}"}) {
    ParameterReader reader = readerOf(yaml);
    int value = 5;
    EXPECT_THROW(reader.read("k", value), std::invalid_argument) << yaml;
    EXPECT_EQ(value, 5);
  }
}

TEST(ParameterReader, AWholeNumberWrittenAsADoubleIsAnInteger) {
  ParameterReader reader = readerOf("{k: 4.0}");
  int value = 0;
  reader.read("k", value);
  EXPECT_EQ(value, 4);
}

TEST(ParameterReader, AQuotedWordIsATextAndNeverATruthValue) {
  ParameterReader reader = readerOf("{k: 'true'}");
  bool flag = false;
  std::string text;
  EXPECT_THAT(messageOf([&] { reader.read("k", flag); }), HasSubstr("wanted true or false"));
  reader.read("k", text);
  EXPECT_FALSE(flag);
  EXPECT_EQ(text, "true");
}

TEST(ParameterReader, AnEmptyListReplacesTheDefault) {
  ParameterReader reader = readerOf("{d: [], s: []}");
  std::vector<double> numbers{1.0};
  std::vector<std::string> texts{"a"};
  reader.read("d", numbers);
  reader.read("s", texts);
  EXPECT_THAT(numbers, testing::IsEmpty());
  EXPECT_THAT(texts, testing::IsEmpty());
}

TEST(ParameterReader, ASlashReachesIntoMapsAtAnyDepth) {
  ParameterReader reader = readerOf("{a: {b: {c: 3, d: 4}}}");
  int c = 0;
  int absent = 9;
  reader.read("a/b/c", c);
  reader.read("a/x/c", absent);
  EXPECT_EQ(c, 3);
  EXPECT_EQ(absent, 9);
  EXPECT_TRUE(reader.has("a/b"));
  EXPECT_FALSE(reader.has("a/b/e"));
}

TEST(ParameterReader, AnUnknownKeyWithinAMapIsNamedByItsPath) {
  ParameterReader reader = readerOf("{a: {b: {width: 3, wdith: 4}}}");
  int width = 0;
  reader.read("a/b/width", width);
  EXPECT_EQ(messageOf([&] { reader.rejectUnknown(); }),
            "/node: unknown parameter 'a/b/wdith'; the nearest known one is 'a/b/width'");
}

TEST(ParameterReader, AValueWhereAMapIsNeededIsRefusedByTheNameOfTheMap) {
  ParameterReader reader = readerOf("{a: {b: 5}}");
  int value = 0;
  EXPECT_EQ(messageOf([&] { reader.read("a/b/c", value); }),
            "/node: parameter 'a/b' is 5, wanted a map");
}

TEST(ParameterReader, WithoutAnyKnownKeyThereIsNoHint) {
  EXPECT_EQ(messageOf([] { readerOf("{oops: 1}").rejectUnknown(); }),
            "/node: unknown parameter 'oops'");
}

TEST(ParameterReader, TheNearestKeyIsTheOneOfTheFewestEdits) {
  // One substitution, one insertion, one deletion, and two edits to another key.
  for (const char* typo : {"scan_topik", "scan_toppic", "scan_topc"}) {
    ParameterReader reader = readerOf(std::string("{") + typo + ": 1}");
    std::string text;
    for (const char* key : {"scan", "scan_rate", "scan_topic", "scan_topics_all"})
      reader.read(key, text);
    EXPECT_THAT(messageOf([&] { reader.rejectUnknown(); }), HasSubstr("'scan_topic'")) << typo;
  }
}

TEST(ParameterReader, AKeyThatWasOnlyAskedForIsKnown) {
  ParameterReader reader = readerOf("{k: 1}");
  EXPECT_TRUE(reader.has("k"));
  EXPECT_EQ(messageOf([&] { reader.rejectUnknown(); }), "nothing was thrown");
}

TEST(ParameterReader, AnAbsentSectionHasOnlyDefaults) {
  ParameterReader reader = readerOf("{other: 1}");
  ParameterReader section = reader.section("noise");
  double sigma_m = 0.25;
  section.read("sigma_m", sigma_m);
  section.rejectUnknown();
  EXPECT_EQ(sigma_m, 0.25);
}

TEST(ParameterReader, ASectionThatIsNoMapIsRefused) {
  ParameterReader reader = readerOf("{noise: [1]}");
  EXPECT_EQ(messageOf([&] { reader.section("noise"); }), "/node/noise: wanted a map of parameters");
}

TEST(ReadYamlFile, NamesAFileThatDoesNotExistOrIsNoYaml) {
  const std::string path = testing::TempDir() + "parameter_reader_test.yaml";
  std::ofstream(path) << "a: [1, 2\n";
  for (const std::string& name : {path, std::string("/does/not/exist.yaml")}) {
    try {
      readYamlFile(name);
      FAIL() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("cannot read " + name));
    }
  }
  std::ofstream(path) << "a: [1, 2]\n";
  EXPECT_EQ(readYamlFile(path)["a"].size(), 2U);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace ram_parameters
