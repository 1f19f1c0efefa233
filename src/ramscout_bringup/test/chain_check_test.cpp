// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/chain_check.hpp"

#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ram_slam::Link;
using ram_slam::Severity;
using testing::HasSubstr;

using Values = std::vector<std::pair<std::string, std::string>>;

NodeReport report(const std::string& name, const std::string& link, Values values = {}) {
  values.insert(values.begin(), {"link", link});
  NodeReport result;
  EXPECT_TRUE(toNodeReport(name, 0, "fine", values, result));
  return result;
}

std::vector<NodeReport> healthy() {
  return {report("/feature_detector: features", "features", {{"input: scan: /scan", "40 Hz"}}),
          report("/laser_odometry: odometry", "odometry", {{"input: odometry: /odom", "100 Hz"}}),
          report("/kinematics: odometry", "kinematics"),
          report("/fast_slam: localisation", "pose", {{"input: features: /features", "40 Hz"}}),
          report("/occupancy_mapper: mapping", "map")};
}

/// The links that are broken.
std::vector<Link> broken(const std::vector<LinkState>& states) {
  std::vector<Link> links;
  for (const LinkState& state : states) {
    if (!state.is_ok) links.push_back(state.link);
  }
  return links;
}

TEST(ChainCheck, OfAHealthyGraphEveryLinkIsOk) {
  const auto states = checkChain(healthy(), {});
  EXPECT_EQ(states.size(), ram_slam::allLinks().size());
  EXPECT_THAT(broken(states), testing::IsEmpty());
  EXPECT_EQ(states[1].text, "/scan: 40 Hz");
}

TEST(ChainCheck, ACauseBreaksItsLinkAndNotThatOfTheNodeThatReportsIt) {
  auto reports = healthy();
  reports[1] = report("/laser_odometry: odometry", "odometry",
                      {{"cause: tf: no transform", "no transform base_link -> laser"}});
  const auto states = checkChain(reports, {});
  EXPECT_THAT(broken(states), testing::Contains(Link::kTf));
  EXPECT_THAT(states[2].text, HasSubstr("no transform base_link -> laser"));
  EXPECT_THAT(states[2].text, HasSubstr("reported by /laser_odometry"));
}

TEST(ChainCheck, AWarningBreaksNoLinkButThatOfTheClock) {
  auto reports = healthy();
  reports.push_back(report("/a: b", "map",
                           {{"warning: map: messages lost", "2 % of the messages lost"},
                            {"warning: clock: clock stands", "the time stands still"}}));
  EXPECT_THAT(broken(checkChain(reports, {})), testing::ElementsAre(Link::kClock));
}

TEST(ChainCheck, ANodeThatDoesNotRunIsNamedWithItsLaunchFile) {
  auto reports = healthy();
  reports.erase(reports.begin() + 3);
  const auto states = checkChain(reports, {});
  EXPECT_EQ(broken(states).back(), Link::kPose);
  EXPECT_THAT(states[6].text, HasSubstr("fast_slam.launch"));
}

TEST(ChainCheck, ANodeThatIsKnownAndReportsNothingIsStopped) {
  auto reports = healthy();
  reports.erase(reports.begin() + 2);
  const auto states = checkChain(reports, {{"/kinematics", Link::kKinematics}});
  EXPECT_THAT(broken(states), testing::ElementsAre(Link::kKinematics));
  EXPECT_THAT(states[4].text, HasSubstr("/kinematics reports nothing"));
}

TEST(ChainCheck, WithoutAnyNodeTheFirstThingToStartIsNamed) {
  const auto states = checkChain({}, {});
  EXPECT_EQ(broken(states).size(), states.size());
  EXPECT_THAT(states.front().text, HasSubstr("slam.launch"));
}

TEST(ChainCheck, StatusesOfOtherNodesAreNotTaken) {
  NodeReport result;
  EXPECT_FALSE(toNodeReport("/battery: level", 0, "full", {{"charge", "1.0"}}, result));
  EXPECT_FALSE(toNodeReport("hokuyo", 0, "OK", {{"link", "scan"}}, result));
  EXPECT_FALSE(toNodeReport("/a: b", 0, "OK", {{"link", "no link"}}, result));
}

}  // namespace
}  // namespace ramscout_bringup
