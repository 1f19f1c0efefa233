// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/report.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "room_results.hpp"

namespace ramscout_bringup {
namespace {

using nlohmann::ordered_json;

/// The room with a landmark and a loop closure.
Results room() {
  Results results = roomResults(100);
  results.trajectory_online = results.trajectory;
  for (auto& pose : results.trajectory_online) pose.pose.y_m += 0.25;
  MapLandmark landmark;
  landmark.id = 7;
  landmark.type = "corner";
  landmark.position_m = {2.0, 5.0};
  landmark.covariance_m2 << 0.04, 0.01, 0.01, 0.02;
  results.landmarks.push_back(landmark);
  results.closures.push_back({100 * kSecond, 108 * kSecond, 0.875, 0.75, 0.125, true});
  results.about = {{"recording", "room.bag"}};
  results.summary = {{"poses", 9}};
  return results;
}

/// What the page's script reads: the content of its data element, as browsers find its end.
ordered_json dataIn(const std::string& html) {
  const std::string begin = "<script type=\"application/json\" id=\"data\">";
  const std::size_t first = html.find(begin) + begin.size();
  return ordered_json::parse(html.substr(first, html.find("</", first) - first));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

std::string fromBase64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned int bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = (bits << 6U) | static_cast<unsigned int>(letters.find(c));
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes += static_cast<char>((bits >> static_cast<unsigned int>(bit_count)) & 0xFFU);
  }
  return bytes;
}

TEST(Report, HoldsMapPathsLandmarksAndClosuresWhereTheyAre) {
  const ordered_json data = dataIn(toHtml(room()));
  ASSERT_EQ(data["paths"].size(), 2U);
  EXPECT_EQ(data["paths"][0]["name"], "online");
  EXPECT_EQ(data["paths"][1]["name"], "final");
  EXPECT_EQ(data["paths"][1]["points"].size(), 27U);
  EXPECT_EQ(data["paths"][1]["points"][3], 200) << "x of the second pose in cm";
  EXPECT_EQ(data["paths"][1]["points"][4], 300);
  EXPECT_EQ(data["paths"][1]["points"][5], 1000) << "ms since the first pose";
  EXPECT_EQ(data["landmarks"][0], ordered_json::parse("[7,\"corner\",2.0,5.0,0.04,0.01,0.02]"));
  EXPECT_EQ(data["closures"][0]["from"], ordered_json::parse("[1.0,3.0,0.0]"));
  EXPECT_EQ(data["closures"][0]["to"], ordered_json::parse("[9.0,3.0,8.0]"));
  EXPECT_EQ(data["closures"][0]["score"], 0.875);
  EXPECT_EQ(data["summary"]["poses"], 9);
  EXPECT_EQ(data["duration_s"], 8.0);
}

TEST(Report, TheMapsPictureIsAPngWithAPixelPerCell) {
  const ordered_json data = dataIn(toHtml(room()));
  const std::string png = fromBase64(data["map"]["png"].get<std::string>());
  const cv::Mat image = cv::imdecode(std::vector<unsigned char>(png.begin(), png.end()), 0);
  ASSERT_EQ(image.cols, 200);
  ASSERT_EQ(image.rows, 120);
  EXPECT_LT(image.at<unsigned char>(119, 50), 50) << "the wall";
  EXPECT_EQ(image.at<unsigned char>(60, 50), 255) << "the floor";
  EXPECT_DOUBLE_EQ(data["map"]["resolution_m"].get<double>(), room().map.resolution_m);
}

TEST(Report, TextsOfARecordingAreNeverHtml) {
  const std::string hostile = "</script><script>alert(1)</script><!--<img src=x onerror=alert(2)>";
  Results results = room();
  results.about = {{"recording", hostile}, {hostile, hostile}};
  results.landmarks[0].type = hostile;
  results.measurements = {
      {hostile, hostile, hostile, {{100 * kSecond, 1.0}, {107 * kSecond, 2.0}}}};
  results.changed_parameters = {{hostile, hostile, hostile, hostile, hostile}};
  results.summary["notes"] = {hostile};
  results.summary[hostile] = hostile;
  const std::string html = toHtml(results);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("<script>alert"), std::string::npos);
  EXPECT_EQ(count(html, "</script"), count(toHtml(room()), "</script"));
  const ordered_json data = dataIn(html);
  EXPECT_EQ(data["about"][0][1], hostile);
  EXPECT_EQ(data["landmarks"][0][1], hostile);
  EXPECT_EQ(data["summary"]["notes"][0], hostile);
}

TEST(Report, BytesThatAreNotUtf8AndValuesThatAreNotFiniteLeaveItReadable) {
  Results results = room();
  results.about = {{"recording", "caf\xe9\xff"}};
  results.landmarks[0].covariance_m2(0, 0) = std::nan("");
  results.closures[0].score = std::nan("");
  results.summary["distance_m"] = std::nan("");
  const ordered_json data = dataIn(toHtml(results));
  EXPECT_TRUE(data["landmarks"][0][4].is_null());
  EXPECT_TRUE(data["closures"][0]["score"].is_null());
}

TEST(Report, RefersToNoOtherFileAndNoNetwork) {
  const std::string html = toHtml(room());
  for (const char* reference : {"http:", "https:", "//www", "<link rel=\"stylesheet", "src=\""})
    EXPECT_EQ(html.find(reference), std::string::npos) << reference;
}

TEST(Report, OfAMillionPosesAndMuchElseStaysWithinThreeMegabytes) {
  Results results = room();
  results.trajectory.clear();
  results.trajectory.reserve(1'000'000);
  for (int i = 0; i < 1'000'000; ++i) {
    const double angle = 1e-3 * i;
    const double radius_m = 50.0 + 1e-4 * i;
    results.trajectory.push_back({kSecond + i * (kSecond / 40),
                                  {radius_m * std::cos(angle), radius_m * std::sin(angle), 0.0}});
  }
  for (std::size_t i = 9; i < results.trajectory.size(); i += 10)
    results.odometry.push_back(results.trajectory[i]);
  results.trajectory_online = results.ground_truth = results.odometry;
  const std::string text(100'000, 'x');
  results.landmarks.assign(50'000, results.landmarks[0]);
  results.closures.assign(50'000, {2 * kSecond, 9000 * kSecond, 0.9, 0.8, 0.1, true});
  for (int i = 0; i < 20'000; ++i) results.summary["notes"].push_back("note " + std::to_string(i));
  results.summary["notes"].push_back(text);
  results.about = {{"recording", text}};
  const std::string html = toHtml(results);
  EXPECT_LT(html.size(), 3'000'000U);
  const ordered_json data = dataIn(html);
  ASSERT_EQ(data["paths"].size(), 4U);
  for (const auto& path : data["paths"]) {
    EXPECT_GT(path["points"].size(), 5'000U) << path["name"];
    // Since the first pose that was known online, the tenth.
    EXPECT_EQ(path["points"].back(), (999'999 - 9) * 25) << "the last pose stays";
  }
  EXPECT_EQ(data["landmark_count"], 50'000) << "what is left out is stated";
}

TEST(Report, AMapWithMoreCellsThanABrowserCanShowIsDrawnSmaller) {
  Results results = room();
  results.map.width = 3000;
  results.map.height = 2000;
  results.map.cells.resize(6'000'000);
  unsigned int random = 1;
  for (auto& cell : results.map.cells) {
    random = random * 1664525U + 1013904223U;
    cell = static_cast<std::int8_t>((random >> 16U) % 101U);
  }
  ReportLimits limits;
  limits.max_map_bytes = 300'000;
  const ordered_json data = reportData(results, limits);
  EXPECT_LT(data["map"]["png"].get<std::string>().size(), 400'100U);
  EXPECT_GT(data["map"]["resolution_m"].get<double>(), results.map.resolution_m);
}

TEST(Report, OdometryBeginsWhereTheFinalPathDoes) {
  Results results = room();
  for (const auto& pose : results.trajectory)
    results.odometry.push_back({pose.stamp_ns, ram_slam::Pose2{5.0, 5.0, 1.0} * pose.pose});
  const ordered_json data = dataIn(toHtml(results));
  EXPECT_EQ(data["paths"][0]["name"], "odometry");
  EXPECT_EQ(data["paths"][0]["points"], data["paths"][2]["points"]);
}

TEST(Report, ErrorsAgainstTheTruthAreThoseOfEachPath) {
  Results results = room();
  results.trajectory_online = results.trajectory;
  for (std::size_t i = 0; i < results.trajectory.size(); ++i) {
    results.ground_truth.push_back(results.trajectory[i]);
    results.ground_truth.back().pose.y_m += 40.0;  // another frame
    results.trajectory_online[i].pose.y_m += i % 2 == 0 ? 0.1 : -0.1;
  }
  const ordered_json data = dataIn(toHtml(results));
  ASSERT_EQ(data["errors"].size(), 2U);
  EXPECT_EQ(data["errors"][0]["path"], "final");
  EXPECT_NEAR(data["errors"][0]["rms_m"].get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(data["errors"][1]["rms_m"].get<double>(), 0.1, 0.01);
}

TEST(Report, ChartsShowMeasurementsAndHowFarPosesWereCorrected) {
  Results results = room();
  results.measurements = {{"scans", "1/s", "", {{101 * kSecond, 10.0}, {107 * kSecond, 12.0}}},
                          {"never measured", "", "", {}}};
  const ordered_json data = dataIn(toHtml(results));
  ASSERT_EQ(data["charts"].size(), 2U);
  EXPECT_EQ(data["charts"][0]["name"], "scans");
  EXPECT_EQ(data["charts"][0]["ranges"][1][3], 12.0);
  EXPECT_EQ(data["charts"][1]["ranges"][0][2], 0.25)
      << "the online path is 25 cm off the final one";
}

TEST(Report, OfNothingIsStillAPageAndTheSameToTheByteEachTime) {
  EXPECT_TRUE(dataIn(toHtml(Results{}))["map"].is_null());
  EXPECT_EQ(toHtml(room()), toHtml(room()));
}

}  // namespace
}  // namespace ramscout_bringup
