// SPDX-License-Identifier: BSD-3-Clause
#include "../src/xml_text.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "ramscout_sim/robot_description.hpp"

#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

std::string nested(int depth, bool closed) {
  std::string text = "<robot name=\"deep\">";
  for (int i = 1; i < depth; ++i) text += "<link name=\"a\">";
  if (!closed) return text;
  for (int i = 1; i < depth; ++i) text += "</link>";
  return text + "</robot>";
}

TEST(XmlText, CountsElementsWithinElements) {
  EXPECT_EQ(depthOfXml(""), 0);
  EXPECT_EQ(depthOfXml("no xml"), 0);
  EXPECT_EQ(depthOfXml("<?xml version=\"1.0\"?><a><b/><c x=\"a>b\"/></a>"), 1);
  EXPECT_EQ(depthOfXml("<a><!-- <b><c> --><d>text</d><d/></a>"), 2);
  EXPECT_EQ(depthOfXml(nested(7, true)), 7);
  EXPECT_EQ(depthOfXml("<"), 1);
  EXPECT_EQ(depthOfXml("<a"), 1);
}

TEST(XmlText, ARobotOfFiftyThousandNestedElementsIsRefusedWithAReason) {
  for (const bool closed : {true, false})
    EXPECT_THAT([&] { parseRobot(nested(50'000, closed), "laser", RobotLimits{}); },
                ::testing::ThrowsMessage<std::exception>(::testing::HasSubstr("nested")));
}

TEST(XmlText, AFileOfARobotIsReadWholeAndRefusalsNameIt) {
  const testing::TemporaryFolder folder;
  EXPECT_EQ(readXml(folder.write("a.urdf", nested(3, true))), nested(3, true));
  const auto read = [](const std::string& path) { readRobot(path); };
  for (const char* name : {"a.urdf", "none.urdf"})
    EXPECT_THAT(testing::refusalOf(read, folder / name), ::testing::HasSubstr(folder / name));
}

}  // namespace
}  // namespace ramscout_sim
