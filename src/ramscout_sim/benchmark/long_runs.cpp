// SPDX-License-Identifier: BSD-3-Clause
// What takes too long for a test: ten minutes of ramming walls, 1e5 rays beside ODE's in three
// worlds, ten runs of ten minutes to the bit. Prints figures; the exit code is 1 if one is not as
// docs/simulator.md states.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>

#include <ode/ode.h>

#include "ramscout_sim/office.hpp"
#include "ramscout_sim/random.hpp"
#include "ramscout_sim/simulation.hpp"

namespace ramscout_sim {
namespace {

int ode_messages = 0;
extern "C" void countOdeMessage(int, const char*, va_list) {
  ++ode_messages;
}

double cpuTime_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

RobotDescription robot() {
  return readRobot(CONFIG_FOLDER "/robots/ramscout.urdf");
}

Office office(int blocks, int seed) {
  OfficeParameters parameters;
  parameters.blocks_along_x = parameters.blocks_along_y = blocks;
  parameters.seed = seed;
  return generateOffice(parameters);
}

World room(double length_m, double width_m) {
  World world;
  world.solids = {makeWall({0, 0}, {length_m, 0}, 0.2, 2.5),
                  makeWall({length_m, 0}, {length_m, width_m}, 0.2, 2.5),
                  makeWall({length_m, width_m}, {0, width_m}, 0.2, 2.5),
                  makeWall({0, width_m}, {0, 0}, 0.2, 2.5)};
  world.start = {0.5 * length_m, 0.5 * width_m, 0.3};
  return world;
}

bool isNan(const Outputs& outputs) {
  if (outputs.ground_truth && !outputs.ground_truth->world_from_base.matrix().allFinite())
    return true;
  if (outputs.odometry && !(std::isfinite(outputs.odometry->odom_from_base.x_m) &&
                            outputs.odometry->covariance.allFinite()))
    return true;
  return outputs.scan && std::any_of(outputs.scan->ranges_m.begin(), outputs.scan->ranges_m.end(),
                                     [](float range) { return std::isnan(range); });
}

/// Full speed ahead, sometimes back, with every turn there is.
bool ramWalls() {
  constexpr double kLength_m = 6.0;
  constexpr double kWidth_m = 4.0;
  Simulation simulation({}, robot(), room(kLength_m, kWidth_m), std::nullopt);
  Random random(1, Stream::kBuilding);
  ode_messages = 0;
  dSetMessageHandler(countOdeMessage);
  Twist2 command;
  int touching = 0;
  int nans = 0;
  int outside = 0;
  double steepest = 1.0;
  constexpr int kSteps = 600'000;
  const double begin_s = cpuTime_s();
  for (int i = 0; i < kSteps; ++i) {
    if (i % 1500 == 0)
      command = {random.uniform() < 0.75 ? 1.5 : -1.5, 0.0, random.uniform(-1.5, 1.5)};
    simulation.command(command);
    const Outputs outputs = simulation.step();
    touching += simulation.inCollision() ? 1 : 0;
    nans += isNan(outputs) ? 1 : 0;
    if (outputs.ground_truth) {
      const Eigen::Isometry3d& pose = outputs.ground_truth->world_from_base;
      const Eigen::Vector3d p = pose.translation();
      outside += p.x() < 0.2 || p.y() < 0.2 || p.x() > kLength_m - 0.2 || p.y() > kWidth_m - 0.2;
      steepest = std::min(steepest, pose.linear()(2, 2));
    }
  }
  const double elapsed_s = cpuTime_s() - begin_s;
  dSetMessageHandler(nullptr);
  std::printf(
      "ram: 600 s in %.2f s (%.0fx), touching a wall %.0f %% of the time; ODE messages %d, NaN %d, "
      "outside %d, upright to %.4f\n",
      elapsed_s, 600.0 / elapsed_s, 100.0 * touching / kSteps, ode_messages, nans, outside,
      steepest);
  return ode_messages == 0 && nans == 0 && outside == 0 && steepest > 0.99;
}

/// ODE's own rays among the same solids.
class OdeRays {
public:
  explicit OdeRays(const World& world)
      : space_(dHashSpaceCreate(nullptr)), ray_(dCreateRay(nullptr, 50.0)) {
    for (const Solid& solid : world.solids) {
      const Eigen::Vector3d& size = solid.size_m;
      const dGeomID geom =
          solid.shape == Shape::kBox      ? dCreateBox(space_, size.x(), size.y(), size.z())
          : solid.shape == Shape::kSphere ? dCreateSphere(space_, 0.5 * size.x())
                                          : dCreateCylinder(space_, 0.5 * size.x(), size.z());
      const Eigen::Vector3d p = solid.world_from_solid.translation();
      const Eigen::Quaterniond q(solid.world_from_solid.linear());
      const dQuaternion quaternion = {q.w(), q.x(), q.y(), q.z()};
      dGeomSetPosition(geom, p.x(), p.y(), p.z());
      dGeomSetQuaternion(geom, quaternion);
    }
    dCreatePlane(space_, 0, 0, 1, 0);
  }
  ~OdeRays() {
    dGeomDestroy(ray_);
    dSpaceDestroy(space_);
  }
  OdeRays(const OdeRays&) = delete;
  OdeRays& operator=(const OdeRays&) = delete;

  double cast(const Ray& ray) {
    dGeomRaySet(ray_, ray.origin_m.x(), ray.origin_m.y(), ray.origin_m.z(), ray.direction.x(),
                ray.direction.y(), ray.direction.z());
    double nearest_m = 50.0;
    dSpaceCollide2(ray_, reinterpret_cast<dGeomID>(space_), &nearest_m,
                   [](void* nearest, dGeomID a, dGeomID b) {
                     dContactGeom contact;
                     if (dCollide(a, b, 1, &contact, sizeof(contact)) > 0)
                       *static_cast<double*>(nearest) =
                           std::min(*static_cast<double*>(nearest), contact.depth);
                   });
    return nearest_m;
  }

private:
  dSpaceID space_;
  dGeomID ray_;
};

bool compareRays(const char* name, const World& world) {
  constexpr int kRays = 100'000;
  const Eigen::AlignedBox3d bounds = boundsOf(world);
  Random random(3, Stream::kBuilding);
  std::vector<Ray> rays;
  while (rays.size() < kRays) {
    const Eigen::Vector3d at(random.uniform(bounds.min().x(), bounds.max().x()),
                             random.uniform(bounds.min().y(), bounds.max().y()), 0.37);
    const bool inside =
        std::any_of(world.solids.begin(), world.solids.end(), [&](const Solid& solid) {
          const Eigen::Vector3d local = solid.world_from_solid.inverse() * at;
          return (local.cwiseAbs() - 0.5 * solid.size_m).maxCoeff() < 0.01;
        });
    if (inside) continue;  // ODE does not see a box from inside
    for (int i = 0; i < 100 && rays.size() < kRays; ++i) {
      const double bearing_rad = random.uniform(0.0, 2.0 * M_PI);
      const Eigen::Vector3d direction(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
      rays.push_back({at.cast<float>(), direction.normalized().cast<float>()});
    }
  }
  const std::vector<float> found = RayCaster(world).cast(rays);
  OdeRays reference(world);
  double largest_m = 0.0;
  int beyond = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double error_m =
        std::abs(std::min(50.0, static_cast<double>(found[i])) - reference.cast(rays[i]));
    largest_m = std::max(largest_m, error_m);
    beyond += error_m > 1e-3 ? 1 : 0;
  }
  std::printf(
      "rays: %s, %zu solids: %d of %d differ from ODE's by more than 1 mm, largest %.3f mm\n", name,
      world.solids.size(), beyond, kRays, 1e3 * largest_m);
  return beyond == 0;
}

void mix(std::uint64_t& hash, const void* data, std::size_t size) {  // FNV-1a
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3ULL;
}

std::uint64_t hashOfRun(const Office& building, double duration_s) {
  Simulation simulation({}, robot(), building.world, building.tour);
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  while (static_cast<double>(simulation.now_ns() - Simulation::kStart_ns) * 1e-9 < duration_s) {
    const Outputs outputs = simulation.step();
    if (outputs.odometry) {
      mix(hash, &outputs.odometry->odom_from_base, sizeof(Pose2));
      mix(hash, outputs.odometry->covariance.data(), 9 * sizeof(double));
      mix(hash, outputs.odometry->wheel_angles_rad.data(), 2 * sizeof(double));
      mix(hash, outputs.ground_truth->world_from_base.matrix().data(), 16 * sizeof(double));
    }
    if (outputs.scan) {
      mix(hash, outputs.scan->ranges_m.data(), outputs.scan->ranges_m.size() * sizeof(float));
    }
  }
  return hash;
}

bool repeat() {
  const Office building = office(2, 1);
  bool same = true;
  std::uint64_t first = 0;
  for (int run = 0; run < 10; ++run) {
    dRandSetSeed(static_cast<unsigned long>(run));
    const double begin_s = cpuTime_s();
    const std::uint64_t hash = hashOfRun(building, 600.0);
    std::printf("repeat: run %d, 600 s: %016llx (%.0fx)\n", run,
                static_cast<unsigned long long>(hash), 600.0 / (cpuTime_s() - begin_s));
    std::fflush(stdout);
    if (run == 0) first = hash;
    same = same && hash == first;
  }
  return same;
}

}  // namespace
}  // namespace ramscout_sim

/// Usage: long_runs [ram|rays|repeat]; all without an argument.
int main(int argc, char** argv) {
  using namespace ramscout_sim;
  const std::string which = argc > 1 ? argv[1] : "all";
  dInitODE2(0);
  bool good = true;
  if (which == "all" || which == "ram") good = ramWalls() && good;
  if (which == "all" || which == "rays") {
    good = compareRays("small office", office(1, 1).world) && good;
    good = compareRays("large office", office(4, 2).world) && good;
    good = compareRays("huge office", office(6, 3).world) && good;
  }
  if (which == "all" || which == "repeat") good = repeat() && good;
  return good ? 0 : 1;
}
