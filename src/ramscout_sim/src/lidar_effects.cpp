// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/lidar_effects.hpp"

#include <algorithm>
#include <cmath>

#include "ramscout_sim/random.hpp"

#include "precision.hpp"

namespace ramscout_sim {
namespace {

/// Where light ends, and what share of it finds back, up to a factor: reflectivity * cos(incidence)
/// / range^2.
struct Echo {
  float range_m = kInfinity;
  double strength = 0.0;
};

/// Follows light through glass and along mirrors.
class Tracer {
public:
  Tracer(const RayCaster& world,
         const std::vector<Solid>& moving,
         const LidarParameters& lidar,
         std::uint64_t seed)
      : world_(world),
        moving_(moving),
        light_(lidar.light),
        farthest_m_(static_cast<float>(lidar.range_max_m) +
                    static_cast<float>(lidar.light.beyond_range_m)),
        behind_surface_m_(static_cast<float>(lidar.light.behind_surface_m)),
        seed_(seed) {}

  /// \param readings  of each ray: rays of the same reading take the same decisions at glass
  /// \param hits  the first surface of each ray
  std::vector<Echo> follow(std::vector<Ray> rays,
                           const std::vector<std::uint64_t>& readings,
                           std::vector<Hit> hits) const {
    std::vector<Echo> echoes(rays.size());
    std::vector<float> passed_m(rays.size(), 0.0F);
    std::vector<std::size_t> owners(rays.size());
    for (std::size_t i = 0; i < owners.size(); ++i) owners[i] = i;
    for (int surface = 0; surface < light_.max_surfaces && !rays.empty(); ++surface) {
      std::size_t going_on = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::size_t owner = owners[i];
        if (hits[i].distance_m == kInfinity) continue;
        const float range_m = passed_m[owner] + hits[i].distance_m;
        if (ends(rays[i], hits[i], readings[owner], surface)) {
          echoes[owner] = {range_m, strengthOf(rays[i], hits[i], range_m)};
          continue;
        }
        passed_m[owner] = range_m + behind_surface_m_;
        rays[going_on] = continued(rays[i], hits[i]);
        owners[going_on++] = owner;
      }
      rays.resize(going_on);
      owners.resize(going_on);
      if (!rays.empty()) hits = trace(rays);
    }
    return echoes;
  }

  std::vector<Hit> trace(const Rays& rays) const {
    std::vector<BeamWindow> everywhere;
    for (std::size_t i = 0; i < moving_.size(); ++i) everywhere.push_back({i, 0, rays.size()});
    return trace(rays, everywhere);
  }

  std::vector<Hit> trace(const Rays& rays, const std::vector<BeamWindow>& windows) const {
    std::vector<Hit> hits = world_.trace(rays, farthest_m_);
    traceMoving(rays, moving_, windows, hits);
    return hits;
  }

private:
  static double incidenceCosine(const Ray& ray, const Hit& hit) {
    return std::min(1.0F, std::abs(ray.direction.dot(hit.normal)));
  }

  double strengthOf(const Ray& ray, const Hit& hit, double range_m) const {
    const double cosine = incidenceCosine(ray, hit);
    const Material& material = world_.materials()[hit.material];
    const double share = material.surface == Surface::kOpaque ? material.reflectivity * cosine
                                                              : light_.white_reflectivity;
    return share / std::max(1e-6, range_m * range_m);
  }

  bool ends(const Ray& ray, const Hit& hit, std::uint64_t reading, int surface) const {
    const Material& material = world_.materials()[hit.material];
    if (material.surface == Surface::kOpaque) return true;
    if (material.surface == Surface::kMirror) return false;
    const bool leaves = !hit.two_sided && ray.direction.dot(hit.normal) > 0.0F;
    if (leaves) return false;  // a pane decides once, where the light enters
    const double incidence_rad = std::acos(incidenceCosine(ray, hit));
    const double ratio = incidence_rad / material.glass_return_angle_rad;
    Random random(seed_, Stream::kGlass,
                  reading * static_cast<std::uint64_t>(light_.max_surfaces) +
                      static_cast<std::uint64_t>(surface));
    return random.uniform() < std::exp(-0.5 * ratio * ratio);
  }

  Ray continued(const Ray& ray, const Hit& hit) const {
    Ray next = ray;
    next.origin_m += hit.distance_m * ray.direction;
    if (world_.materials()[hit.material].surface == Surface::kMirror) {
      next.direction -= 2.0F * ray.direction.dot(hit.normal) * hit.normal;
    }
    next.origin_m += behind_surface_m_ * next.direction;
    return next;
  }

  const RayCaster& world_;
  const std::vector<Solid>& moving_;
  LightParameters light_;
  float farthest_m_;
  float behind_surface_m_;
  std::uint64_t seed_;
};

bool isEdge(const Echo& a, const Echo& b, float edge_m) {
  return a.range_m != b.range_m && !(std::abs(a.range_m - b.range_m) <= edge_m);
}

/// Adds `count` rays of a beam's footprint, spread along the scan: towards the neighbouring beam
/// and away from it.
void addFootprint(const Rays& rays,
                  std::size_t beam,
                  double pitches_to_rim,
                  int count,
                  std::vector<Ray>& footprint) {
  const bool last = beam + 1 == rays.size();
  const Eigen::Vector3f to_next =
      last ? Eigen::Vector3f(rays[beam].direction - rays[beam - 1].direction)
           : Eigen::Vector3f(rays[beam + 1].direction - rays[beam].direction);
  for (int i = 0; i < count; ++i) {
    const double share = 2.0 * i / (count - 1) - 1.0;
    Ray ray = rays[beam];
    ray.direction += static_cast<float>(share * pitches_to_rim) * to_next;
    ray.direction.normalize();
    footprint.push_back(ray);
  }
}

/// The reading of a beam whose footprint sends several echoes: neighbours in range melt together,
/// the strongest lump counts.
Echo combine(std::vector<Echo> echoes, double pulse_length_m) {
  const auto count = static_cast<double>(echoes.size());
  std::sort(echoes.begin(), echoes.end(),
            [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
  Echo strongest;
  Echo lump;
  double moment = 0.0;
  float previous_m = -kInfinity;
  for (const Echo& echo : echoes) {
    if (echo.range_m == kInfinity) break;
    if (echo.range_m - previous_m > pulse_length_m) {
      lump = {};
      moment = 0.0;
    }
    previous_m = echo.range_m;
    lump.strength += echo.strength / count;
    moment += echo.strength / count * echo.range_m;
    lump.range_m = lump.strength > 0.0 ? static_cast<float>(moment / lump.strength) : echo.range_m;
    if (lump.strength >= strongest.strength) strongest = lump;
  }
  return strongest;
}

/// Replaces the echoes of beams at edges by those of their footprints.
void mixEdges(const Illumination& scan,
              const LidarParameters& lidar,
              const Tracer& tracer,
              std::uint64_t first_reading,
              std::vector<Echo>& echoes) {
  std::vector<std::size_t> beams;
  std::vector<Ray> footprints;
  std::vector<std::uint64_t> readings;
  const auto edge_m = static_cast<float>(lidar.light.edge_m);
  const std::ptrdiff_t rays_per_beam = lidar.light.footprint_rays;
  const double pitches_to_rim = lidar.beam_divergence_rad / lidar.angleIncrement_rad();
  for (std::size_t beam = 0; beam < echoes.size(); ++beam) {
    const bool edge = (beam > 0 && isEdge(echoes[beam - 1], echoes[beam], edge_m)) ||
                      (beam + 1 < echoes.size() && isEdge(echoes[beam], echoes[beam + 1], edge_m));
    if (!edge) continue;
    beams.push_back(beam);
    addFootprint(scan.rays, beam, pitches_to_rim, lidar.light.footprint_rays, footprints);
    readings.insert(readings.end(), static_cast<std::size_t>(rays_per_beam), first_reading + beam);
  }
  if (beams.empty()) return;
  const std::vector<Echo> parts = tracer.follow(footprints, readings, tracer.trace(footprints));
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const auto own = parts.begin() + rays_per_beam * static_cast<std::ptrdiff_t>(i);
    echoes[beams[i]] = combine({own, own + rays_per_beam}, lidar.pulse_length_m);
  }
}

}  // namespace

bool needsEffects(const LidarParameters& lidar,
                  const RayCaster& world,
                  const std::vector<Solid>& moving) {
  return lidar.half_detection_range_m > 0.0 || lidar.beam_divergence_rad > 0.0 ||
         world.hasClearSurfaces() ||
         std::any_of(moving.begin(), moving.end(), [&world](const Solid& solid) {
           return world.materials()[solid.material].surface != Surface::kOpaque;
         });
}

std::vector<float> illuminate(const Illumination& scan,
                              const LidarParameters& lidar,
                              std::uint64_t seed,
                              std::uint64_t first_reading) {
  const Tracer tracer(scan.world, scan.moving, lidar, seed);
  std::vector<Hit> hits = tracer.trace(scan.rays, scan.windows);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < scan.rays.size(); ++i) rays.push_back(scan.rays[i]);
  std::vector<std::uint64_t> readings(scan.rays.size());
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i] = first_reading + i;
  std::vector<Echo> echoes = tracer.follow(std::move(rays), readings, std::move(hits));
  if (lidar.beam_divergence_rad > 0.0) mixEdges(scan, lidar, tracer, first_reading, echoes);

  std::vector<float> ranges_m(echoes.size());
  const double half_range_m = lidar.half_detection_range_m;
  const double half_strength =
      half_range_m > 0.0 ? lidar.light.white_reflectivity / (half_range_m * half_range_m) : 0.0;
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    ranges_m[i] = echoes[i].range_m;
    if (half_strength == 0.0 || ranges_m[i] == kInfinity) continue;
    const double chance =
        1.0 / (1.0 + std::pow(half_strength / echoes[i].strength, lidar.light.detection_steepness));
    if (Random(seed, Stream::kDropout, readings[i]).uniform() >= chance) ranges_m[i] = kInfinity;
  }
  return ranges_m;
}

}  // namespace ramscout_sim
