// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar_parameters.hpp"

#include <cmath>
#include <stdexcept>

namespace ramscout_sim {
namespace {

using ram_parameters::ParameterTable;
using P = LidarParameters;

// Data sheets' values where they state any; the noise is a Gaussian within the stated accuracy.

/// Steps 44 to 725 of 1024 a turn, 100 ms a turn.
LidarParameters urg04lx() {
  LidarParameters p;
  p.beams = 682;
  p.angle_max_rad = 341 * 2.0 * M_PI / 1024;
  p.angle_min_rad = -340 * 2.0 * M_PI / 1024;
  p.scan_rate_hz = 10.0;
  p.time_increment_s = 0.1 / 1024;
  p.range_min_m = 0.02;
  p.range_max_m = 5.6;
  p.range_sigma_m = 0.01;
  p.range_sigma_per_m = 0.01;
  p.far_range_sigma_m = 0.0;
  return p;
}

/// LMS 200, 75 turns a second. Half a degree (`fine`) takes two turns, of which each gives every
/// other beam; the file formats of old logs leave out the last of the 181 beams of a single turn.
LidarParameters sickLms(bool fine) {
  LidarParameters p;
  p.beams = fine ? 361 : 180;
  p.angle_min_rad = -M_PI_2;
  p.angle_max_rad = fine ? M_PI_2 : M_PI_2 - M_PI / 180.0;
  p.scan_rate_hz = fine ? 37.5 : 75.0;
  p.time_increment_s = 1.0 / 75.0 / (fine ? 720.0 : 360.0);
  p.range_min_m = 0.05;
  p.range_max_m = 80.0;
  p.range_sigma_m = 0.005;
  p.range_resolution_m = 0.01;
  p.far_range_sigma_m = 0.0;
  return p;
}

LidarParameters rplidarA2() {
  LidarParameters p;
  p.beams = 360;
  p.angle_min_rad = -M_PI;
  p.angle_max_rad = M_PI - 2.0 * M_PI / 360;
  p.scan_rate_hz = 10.0;
  p.time_increment_s = 0.1 / 360;
  p.range_min_m = 0.15;
  p.range_max_m = 12.0;
  p.range_sigma_m = 0.01;
  p.range_sigma_per_m = 0.01;
  p.far_range_sigma_m = 0.0;
  return p;
}

void addScan(ParameterTable<P>& table) {
  using namespace ram_parameters;
  table
      .add("preset", &P::preset,
           "utm_30lx, urg_04lx, sick_lms (361 beams), sick_lms_180 or rplidar_a2; every other key "
           "overrides the preset. The values below are those of utm_30lx: remove them to use "
           "another preset.")
      .add("beams", &P::beams, "", within(2, kMaxBeams), "Readings of a scan.")
      .add("angle_min_rad", &P::angle_min_rad, "rad", atLeast(-2.0 * M_PI), "First beam.")
      .add("angle_max_rad", &P::angle_max_rad, "rad", anyNumber(), "Last beam.")
      .rule(&P::angle_max_rad, "> angle_min_rad",
            [](const P& p) { return p.angle_max_rad > p.angle_min_rad; })
      .rule(&P::angle_max_rad, "at most a turn after angle_min_rad",
            [](const P& p) { return p.angle_max_rad - p.angle_min_rad <= 2.0 * M_PI; })
      .add("scan_rate_hz", &P::scan_rate_hz, "1/s", aboveUpTo(0.0, 1000.0), "Scans per second.")
      .add("time_increment_s", &P::time_increment_s, "s", atLeast(0.0),
           "Time from one beam to the next; 0: all at once.")
      .rule(&P::time_increment_s, "so small that a sweep fits between two scans",
            [](const P& p) { return p.sweep_s() <= 1.0 / p.scan_rate_hz; })
      .add("range_min_m", &P::range_min_m, "m", atLeast(0.0), "Nearer readings are -Inf (REP 117).")
      .add("range_max_m", &P::range_max_m, "m", anyNumber(), "Farther readings are +Inf (REP 117).")
      .rule(&P::range_max_m, "> range_min_m",
            [](const P& p) { return p.range_max_m > p.range_min_m; });
}

void addNoise(ParameterTable<P>& table) {
  using namespace ram_parameters;
  table
      .add("range_sigma_m", &P::range_sigma_m, "m", atLeast(0.0),
           "Standard deviation of a range: the largest of this, the next times the range, and, "
           "from far_range_m on, far_range_sigma_m.")
      .add("range_sigma_per_m", &P::range_sigma_per_m, "m/m", {0.0, 1.0, true, false}, "See above.")
      .add("far_range_sigma_m", &P::far_range_sigma_m, "m", atLeast(0.0), "See above.")
      .add("far_range_m", &P::far_range_m, "m", atLeast(0.0), "See above.")
      .add("range_bias_sigma_m", &P::range_bias_sigma_m, "m", atLeast(0.0),
           "Standard deviation of an error that all beams share for a whole run.")
      .add("warm_up_drift_m", &P::warm_up_drift_m, "m", between(-1.0, 1.0),
           "All ranges are this much too long at first.")
      .add("warm_up_time_s", &P::warm_up_time_s, "s", positive(),
           "Time constant with which that error decays.")
      .add("range_resolution_m", &P::range_resolution_m, "m", {0.0, 1.0, true, false},
           "Ranges are multiples of it; 0: not rounded.")
      .add("outlier_probability", &P::outlier_probability, "", within(0.0, 1.0),
           "Chance of a reading anywhere before the surface.");
}

/// What light does beyond hitting the first surface.
void addLight(ParameterTable<P>& table) {
  using namespace ram_parameters;
  table
      .heading(
          "Light: 0 switches an effect off, and then it costs nothing; glass and mirrors of the "
          "world always count")
      .add("half_detection_range_m", &P::half_detection_range_m, "m", atLeast(0.0),
           "A white wall there, hit head-on, answers every other time; 0: all always do. A "
           "UTM-30LX comes near 60, a URG-04LX near 10; dark and slanted surfaces drop out first.")
      .add("beam_divergence_rad", &P::beam_divergence_rad, "rad", within(0.0, 0.1),
           "Half angle of a beam's footprint; 0: no mixed pixels. Hokuyo: about 0.0013.")
      .add("pulse_length_m", &P::pulse_length_m, "m", atLeast(0.0),
           "Echoes of one beam less apart than this mix, of others the strongest counts.")
      .expert("How light is followed")
      .section("light", &P::light, LightParameters::table());
}

}  // namespace

const ParameterTable<LightParameters>& LightParameters::table() {
  using namespace ram_parameters;
  using Light = LightParameters;
  static const auto table =
      ParameterTable<Light>()
          .add("white_reflectivity", &Light::white_reflectivity, "", aboveUpTo(0.0, 1.0),
               "Reflectivity of the wall that half_detection_range_m is stated for.")
          .add("detection_steepness", &Light::detection_steepness, "", positive(),
               "Chance of an answer: 1 / (1 + (half strength / strength)^steepness).")
          .add("edge_m", &Light::edge_m, "m", positive(),
               "Neighbouring readings that differ more have an edge between them.")
          .add("beyond_range_m", &Light::beyond_range_m, "m", atLeast(0.0),
               "How far beyond range_max_m surfaces can still make an edge.")
          .add("footprint_rays", &Light::footprint_rays, "", within(2, 100),
               "Rays that stand for the footprint of a beam at an edge.")
          .add("max_surfaces", &Light::max_surfaces, "", within(1, 1000),
               "Most surfaces that one beam passes or is mirrored by.")
          .add("behind_surface_m", &Light::behind_surface_m, "m", positive(),
               "How far behind a surface light continues, so that it does not meet it again.");
  return table;
}

const ParameterTable<LidarParameters>& LidarParameters::table() {
  static const auto table = [] {
    ParameterTable<P> rows;
    addScan(rows);
    addNoise(rows);
    addLight(rows);
    return rows;
  }();
  return table;
}

LidarParameters lidarPreset(const std::string& name) {
  LidarParameters p;
  if (name == "urg_04lx") {
    p = urg04lx();
  } else if (name == "sick_lms" || name == "sick_lms_180") {
    p = sickLms(name == "sick_lms");
  } else if (name == "rplidar_a2") {
    p = rplidarA2();
  } else if (name != "utm_30lx") {
    throw std::invalid_argument(
        "lidar/preset must be utm_30lx, urg_04lx, sick_lms, sick_lms_180 or rplidar_a2, got '" +
        name + "'");
  }
  p.preset = name;
  return p;
}

LidarParameters readLidarParameters(ram_parameters::ParameterReader& reader) {
  LidarParameters p;
  reader.read("preset", p.preset);
  p = lidarPreset(p.preset);
  LidarParameters::table().read(reader, p);
  reader.rejectUnknown();
  p.validate();
  return p;
}

}  // namespace ramscout_sim
