// SPDX-License-Identifier: BSD-3-Clause
// How good a trajectory is: against the truth, or against a file of relations.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "ram_slam/io/atomic_file.hpp"
#include "ramscout_bringup/evaluation.hpp"

namespace {

using namespace ramscout_bringup;  // NOLINT(google-build-using-namespace): a program about this
                                   // library

constexpr double kDegrees = 180.0 / M_PI;  // in a radian

struct Row {
  std::string name;
  const char* unit;
  double scale;
  ErrorStatistics errors;
};

nlohmann::ordered_json toJson(const std::vector<Row>& rows) {
  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  for (const Row& row : rows) {
    const ErrorStatistics& e = row.errors;
    table.push_back({{"name", row.name},
                     {"unit", row.unit},
                     {"count", e.count},
                     {"mean", row.scale * e.mean},
                     {"std", row.scale * e.standard_deviation},
                     {"rms", row.scale * e.rms},
                     {"median", row.scale * e.median},
                     {"max", row.scale * e.max}});
  }
  return table;
}

void print(const std::vector<Row>& rows) {
  std::printf("%-46s %4s %7s %9s %9s %9s %9s %9s\n", "error", "unit", "count", "mean", "std", "rms",
              "median", "max");
  for (const Row& row : rows) {
    const ErrorStatistics& e = row.errors;
    std::printf("%-46s %4s %7zu %9.4f %9.4f %9.4f %9.4f %9.4f\n", row.name.c_str(), row.unit,
                e.count, row.scale * e.mean, row.scale * e.standard_deviation, row.scale * e.rms,
                row.scale * e.median, row.scale * e.max);
  }
}

void addRows(const std::string& pairs, const RelationErrors& errors, std::vector<Row>& rows) {
  rows.push_back({pairs + ": translation", "m", 1.0, errors.position_m});
  rows.push_back(
      {pairs + ": translation, Cartographer's", "m", 1.0, errors.position_cartographer_m});
  rows.push_back({pairs + ": rotation", "deg", kDegrees, errors.yaw_rad});
}

std::vector<Row> againstTruth(const Trajectory& estimate, const std::string& truth_path) {
  const Trajectory truth = readTrajectory(truth_path);
  const TruthComparison comparison = compareWithTruth(estimate, truth);
  if (comparison.without_truth_count > 0) {
    std::printf("%zu of %zu poses left out: the truth has no pose around their stamps\n",
                comparison.without_truth_count, estimate.size());
  }
  std::vector<Row> rows{{"absolute, aligned (ATE): position", "m", 1.0, comparison.position_m},
                        {"absolute, aligned (ATE): yaw", "deg", kDegrees, comparison.yaw_rad}};
  for (const RelativeError& row : relativeErrors(estimate, truth, {1.0, 5.0}, {10.0})) {
    rows.push_back(
        {"relative (RPE) over " + row.interval + ": position", "m", 1.0, row.position_m});
    rows.push_back({"relative (RPE) over " + row.interval + ": yaw", "deg", kDegrees, row.yaw_rad});
  }
  return rows;
}

std::vector<Row> againstRelations(const Trajectory& estimate,
                                  const std::string& relations_path,
                                  const std::string& odometry_path) {
  const RelationComparison comparison =
      compareWithRelations(estimate, readRelations(relations_path),
                           odometry_path.empty() ? Trajectory() : readTrajectory(odometry_path));
  std::vector<Row> rows;
  addRows("all pairs", comparison.all, rows);
  addRows("pairs > 30 s apart", comparison.distant, rows);
  std::printf(
      "%zu relations; farthest pose used %.3f s away; %zu stamps more than 0.1 s from any pose, "
      "%zu of them "
      "bridged by odometry\n",
      comparison.all.position_m.count, comparison.max_stamp_gap_s, comparison.far_count,
      comparison.moved_count);
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Error of a trajectory (TUM format) against the truth or against relations; files may be .gz "
      "or .xz.");
  std::string trajectory;
  std::string truth;
  std::string relations;
  std::string odometry;
  std::string json;
  app.add_option("trajectory", trajectory, "trajectory to evaluate")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--ground-truth", truth, "true trajectory")->check(CLI::ExistingFile);
  app.add_option("--relations", relations, "lines 't1 t2 x y z roll pitch yaw'")
      ->check(CLI::ExistingFile);
  app.add_option("--odometry", odometry, "trajectory that bridges gaps between poses and relations")
      ->check(CLI::ExistingFile);
  app.add_option("--json", json, "also write the table to this file");
  CLI11_PARSE(app, argc, argv);
  if (truth.empty() == relations.empty()) {
    std::cerr << "evaluate: wanted one of --ground-truth and --relations\n";
    return EXIT_FAILURE;
  }
  try {
    const Trajectory estimate = readTrajectory(trajectory);
    const std::vector<Row> rows = truth.empty() ? againstRelations(estimate, relations, odometry)
                                                : againstTruth(estimate, truth);
    print(rows);
    if (!json.empty()) ram_slam::writeFileAtomically(json, toJson(rows).dump(2) + "\n");
  } catch (const std::exception& error) {
    std::cerr << "evaluate: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
