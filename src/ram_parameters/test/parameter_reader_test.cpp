// SPDX-License-Identifier: BSD-3-Clause
#include "ram_parameters/parameter_reader.hpp"

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

}  // namespace
}  // namespace ram_parameters
