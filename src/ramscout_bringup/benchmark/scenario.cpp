// SPDX-License-Identifier: BSD-3-Clause
#include "scenario.hpp"

#include <filesystem>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <ram_parameters/parameter_reader.hpp>

namespace ramscout_bringup {
namespace {

constexpr double kLongest_s = 36000.0;  // ten hours; more is a slip of the pen

std::string fileBeside(const std::string& path,
                       const std::string& key,
                       ram_parameters::ParameterReader& reader) {
  std::string name;
  reader.read(key, name);
  if (name.empty()) throw std::invalid_argument(path + ": " + key + " must name a file");
  const std::filesystem::path file = std::filesystem::path(path).parent_path() / name;
  if (!std::filesystem::is_regular_file(file))
    throw std::invalid_argument(path + ": " + key + ": there is no file " + file.string());
  return file.lexically_normal().string();
}

/// A name stays as it is; a path is relative to the folder of the scenario.
void readPreset(const std::string& path,
                const std::string& key,
                ram_parameters::ParameterReader& reader,
                std::string& name) {
  reader.read(key, name);
  if (name.find('/') == std::string::npos) return;
  name = (std::filesystem::path(path).parent_path() / name).lexically_normal().string();
}

std::map<std::string, double> readLimits(ram_parameters::ParameterReader reader) {
  std::map<std::string, double> limits;
  for (const FigureKind& kind : figureKinds()) {
    double limit = 0.0;
    if (!reader.has(kind.name)) continue;
    reader.read(kind.name, limit);
    limits[kind.name] = limit;
  }
  reader.rejectUnknown();
  return limits;
}

}  // namespace

const std::vector<FigureKind>& figureKinds() {
  static const std::vector<FigureKind> kinds = {
      {"tour_driven", true},  {"ate_m", false},         {"online_ate_m", false},
      {"yaw_rms_rad", false}, {"rpe_5m_m", false},      {"map_iou", true},
      {"map_coverage", true}, {"wall_m", false},        {"times_lost", false},
      {"cpu_s_per_s", false}, {"peak_memory_mb", false}};
  return kinds;
}

Scenario readScenario(const std::string& path) {
  const YAML::Node file = ram_parameters::readYamlFile(path);
  ram_parameters::ParameterReader reader(file, path);
  Scenario scenario;
  scenario.name = std::filesystem::path(path).stem().string();
  scenario.world = fileBeside(path, "world", reader);
  scenario.tour = fileBeside(path, "tour", reader);
  readPreset(path, "robot", reader, scenario.robot);
  readPreset(path, "lidar", reader, scenario.lidar);
  if (scenario.robot.empty()) throw std::invalid_argument(path + ": robot must name a robot");
  reader.read("estimator", scenario.estimator);
  reader.read("map_by", scenario.map_by);
  reader.read("heading_offset_rad", scenario.heading_offset_rad);
  reader.read("most_s", scenario.most_s);
  if (!(scenario.most_s > 0.0 && scenario.most_s <= kLongest_s))
    throw std::invalid_argument(path + ": most_s must be in (0, 36000] s");
  if (reader.has("faults")) scenario.faults = ramscout_sim::readFaults(file["faults"], path);
  scenario.limits = readLimits(reader.section("limits"));
  if (scenario.limits.empty()) throw std::invalid_argument(path + ": limits must have a limit");
  reader.rejectUnknown();
  return scenario;
}

std::vector<std::string> brokenLimits(const Scenario& scenario,
                                      const std::map<std::string, double>& figures) {
  std::vector<std::string> broken;
  for (const FigureKind& kind : figureKinds()) {
    const auto limit = scenario.limits.find(kind.name);
    if (limit == scenario.limits.end()) continue;
    const auto figure = figures.find(kind.name);
    const double value =
        figure == figures.end() ? std::numeric_limits<double>::quiet_NaN() : figure->second;
    const bool kept = kind.at_least ? value >= limit->second : value <= limit->second;
    if (kept) continue;
    std::ostringstream line;
    line << kind.name << " is " << value << ", must be at " << (kind.at_least ? "least " : "most ")
         << limit->second;
    broken.push_back(line.str());
  }
  return broken;
}

}  // namespace ramscout_bringup
