// SPDX-License-Identifier: BSD-3-Clause
// The whole stack on a recording, as fast as it goes: a ROS bag or a CARMEN log in, the files of a
// run out.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <variant>

#include <CLI/CLI.hpp>
#include <boost/timer/progress_display.hpp>
#include <malloc.h>
#include <ros/package.h>
#include <sys/resource.h>
#include <unistd.h>

#include "ram_slam/io/atomic_file.hpp"
#include "ramscout_bringup/slam_pipeline.hpp"

#include "../ros/recording_options.hpp"
#include "../ros/ros_recording.hpp"

namespace {

volatile std::sig_atomic_t stop_requested = 0;
void requestStop(int /*signal*/) {
  stop_requested = 1;
}

struct Options {
  std::string input;
  std::string output;
  std::string config;
  bool wheels_only = false;
  bool no_smoothing = false;
  bool live_settings = false;
  std::string estimator = "fast_slam";
  ramscout_bringup::RecordingOptions recording;
};

void feed(ramscout_bringup::Recording& recording, ramscout_bringup::SlamPipeline& pipeline) {
  constexpr unsigned long kSteps = 100;  // percent
  boost::timer::progress_display bar(kSteps, std::cout);
  while (auto reading = recording.next()) {
    std::visit([&](auto&& value) { pipeline.add(std::move(value)); }, std::move(*reading));
    const auto step = static_cast<unsigned long>(kSteps * recording.progress());
    if (step > bar.count()) bar += step - bar.count();
    if (stop_requested != 0) {
      std::cout << "\nstopped; writing what there is\n";
      return;
    }
  }
}

/// What the run cost. Kept apart from summary.json, which is the same for every repetition.
nlohmann::ordered_json cost(double recorded_s) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  const double cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  return {{"cpu_s", cpu_s},
          {"recorded_s", recorded_s},
          {"times_real_time", recorded_s / cpu_s},
          {"peak_memory_mb", static_cast<double>(usage.ru_maxrss) / 1024.0}};
}

/// What the report states about this run.
void describe(const Options& options,
              const ramscout_bringup::Recording& recording,
              ramscout_bringup::Results& results) {
  results.scan_count = recording.scanCount();
  const std::filesystem::path input =
      std::filesystem::path(options.input + "/").parent_path();  // without a slash at the end
  results.about = {
      {"recording", input.filename().string()},
      {"made by", "run_bag"},
      {"estimator", options.estimator},
      {"settings", options.live_settings ? "those of the live nodes" : "for recordings"}};
  if (options.wheels_only) results.about.emplace_back("laser odometry", "off");
  if (options.no_smoothing) results.about.emplace_back("smoothing", "off");
  if (stop_requested != 0) results.about.emplace_back("stopped", "before the end");
  results.changed_parameters =
      ramscout_bringup::changedParameters(options.config, options.estimator);
}

/// Maps a recording. What only the mapping needs is released at the end of it.
ramscout_bringup::Results map(ramscout_bringup::Recording& recording, const Options& options) {
  auto parameters = ramscout_bringup::readSlamParameters(options.config, options.estimator);
  if (!options.live_settings) parameters.useBatchSettings();
  parameters.use_laser_odometry = !options.wheels_only;
  parameters.use_map_smoother = !options.no_smoothing;
  ramscout_bringup::SlamPipeline pipeline(parameters);
  feed(recording, pipeline);
  std::vector<std::string> notes = recording.notes();
  for (const std::string& note : notes) std::cout << note << "\n";
  ramscout_bringup::Results results = pipeline.finish();
  if (!options.wheels_only) {
    notes.push_back("lidar: " + results.summary["lidar"]["meaning"].get<std::string>());
    std::cout << notes.back() << "\n";
  }
  results.summary["notes"] = notes;
  describe(options, recording, results);
  return results;
}

/// \return whether the map stands on at least half of the scans
bool run(const Options& options) {
  const auto recording = ramscout_bringup_ros::openRecording(options.input, options.recording);
  // Before the work, not after it.
  std::filesystem::create_directories(options.output);
  if (::access(options.output.c_str(), W_OK | X_OK) != 0)
    throw std::system_error(errno, std::generic_category(), "writing to " + options.output);
  const ramscout_bringup::Results results = map(*recording, options);
  malloc_trim(0);  // gives back what the mapping took, before the picture takes as much again
  ramscout_bringup::writeResults(results, options.output);
  const nlohmann::ordered_json timing = cost(results.summary["duration_s"]);
  ram_slam::writeFileAtomically(options.output + "/timing.json", timing.dump(2) + "\n");
  std::cout << results.summary.dump(2) << "\n" << timing.dump(2) << "\n";
  const std::size_t used = results.trajectory_online.size();
  if (2 * used >= recording->scanCount() || stop_requested != 0) return true;
  std::cerr << "run_bag: only " << used << " of " << recording->scanCount()
            << " scans could be used; summary.json has the reasons under notes and left_out\n";
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Runs the whole SLAM stack on a recording, as fast as it goes, and writes map, trajectory, "
      "landmarks, picture and "
      "summary. Ctrl-C or SIGTERM stops early with what there is.");
  Options options;
  options.output = "results";
  app.add_option(
         "input", options.input,
         "recording: ROS bag (.bag), ROS 2 recording (.mcap, .db3, or their folder) or CARMEN log "
         "(.clf, .log, also .gz, .xz)")
      ->required()
      ->check(CLI::ExistingPath);
  app.add_option("--output", options.output, "folder to write to, made if missing")
      ->capture_default_str();
  app.add_option("--config", options.config,
                 "folder with the nodes' parameter files; default: the installed one")
      ->check(CLI::ExistingDirectory);
  ramscout_bringup_ros::addOptions(app, options.recording);
  app.add_flag("--wheels-only", options.wheels_only,
               "no laser odometry: the wheels' odometry as it is, no smoothing");
  app.add_flag("--no-smoothing", options.no_smoothing,
               "the final trajectory is the estimator's own");
  app.add_flag("--live-settings", options.live_settings,
               "the settings of the live nodes: every scan updates the estimator, and the smoother "
               "optimises while driving");
  app.add_option("--estimator", options.estimator, "name of the estimator")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGINT, requestStop);
  std::signal(SIGTERM, requestStop);
  try {
    if (options.config.empty())
      options.config = ros::package::getPath("ramscout_bringup") + "/config";
    if (!run(options)) return EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::cerr << "run_bag: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
