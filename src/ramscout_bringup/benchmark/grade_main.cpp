// SPDX-License-Identifier: BSD-3-Clause
// Drives a scenario in simulation, maps it, and reports whether its limits are kept.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <ram_slam/io/atomic_file.hpp>
#include <ros/package.h>

#include "grade.hpp"

namespace {

using namespace ramscout_bringup;

struct Options {
  std::string scenario;
  std::vector<int> seeds = {1};
  std::string config;
  std::string output = "grade";
};

/// What a run of one seed adds to the reports.
struct Report {
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  std::string cases;  ///< of JUnit
  int failed = 0;
};

void print(const Scenario& scenario, int seed, const Grade& grade) {
  std::printf("%s, seed %d\n", scenario.name.c_str(), seed);
  for (const FigureKind& kind : figureKinds()) {
    std::printf("  %-16s %10.4g", kind.name, grade.figures.at(kind.name));
    const auto limit = scenario.limits.find(kind.name);
    if (limit != scenario.limits.end())
      std::printf("   at %s %.4g", kind.at_least ? "least" : "most", limit->second);
    std::printf("\n");
  }
  std::fflush(stdout);
}

void add(const Scenario& scenario, int seed, const Grade& grade, Report& report) {
  const std::vector<std::string> broken = brokenLimits(scenario, grade.figures);
  report.runs.push_back({{"seed", seed}, {"figures", grade.figures}, {"broken", broken}});
  std::ostringstream test;
  test << "  <testcase classname=\"grade\" name=\"" << scenario.name << " seed " << seed << "\">\n";
  for (const std::string& line : broken) {
    std::fprintf(stderr, "grade: %s, seed %d: %s\n", scenario.name.c_str(), seed, line.c_str());
    test << "    <failure message=\"" << line << "\"/>\n";
  }
  report.cases += test.str() + "  </testcase>\n";
  report.failed += broken.empty() ? 0 : 1;
}

bool run(const Options& options) {
  const Scenario scenario = readScenario(options.scenario);
  Report report;
  for (const int seed : options.seeds) {
    const std::string folder = options.output + "/" + scenario.name + "_" + std::to_string(seed);
    std::filesystem::create_directories(folder);  // before the work, not after it
    const Grade result = grade(scenario, options.config, seed);
    writeResults(result.results, folder);
    print(scenario, seed, result);
    add(scenario, seed, result, report);
  }
  const std::string name = options.output + "/" + scenario.name;
  const nlohmann::ordered_json figures = {
      {"scenario", scenario.name}, {"limits", scenario.limits}, {"runs", report.runs}};
  ram_slam::writeFileAtomically(name + ".json", figures.dump(2) + "\n");
  std::ostringstream junit;
  junit << "<?xml version=\"1.0\"?>\n<testsuite name=\"grade\" tests=\"" << options.seeds.size()
        << "\" failures=\"" << report.failed << "\" errors=\"0\">\n"
        << report.cases << "</testsuite>\n";
  ram_slam::writeFileAtomically(name + ".xml", junit.str());
  return report.failed == 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Drives a scenario in simulation, maps it, and checks the limits stated in it.");
  Options options;
  app.add_option("SCENARIO", options.scenario, "scenario file, as in config/scenarios")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("SEED", options.seeds, "of the noise; one run for each")->capture_default_str();
  app.add_option("--config", options.config,
                 "folder with the nodes' parameter files; default: the installed one")
      ->check(CLI::ExistingDirectory);
  app.add_option("--output", options.output, "folder to write to, made if missing")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    if (options.config.empty())
      options.config = ros::package::getPath("ramscout_bringup") + "/config";
    return run(options) ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::cerr << "grade: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}
