// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/fast_slam/landmark_registry.hpp"

#include <algorithm>
#include <stdexcept>

#include "ram_slam/geometry/pose2.hpp"

namespace ram_slam {
namespace {

constexpr int kSectors = 16;  // bits of LandmarkRecord::seen_from that are used: 22.5 deg each

bool before(const LandmarkRecord& record, LandmarkId id) {
  return record.id < id;
}

std::uint32_t sectorBit(const Eigen::Vector2d& direction) {
  const double turn = (std::atan2(direction.y(), direction.x()) + M_PI) / (2.0 * M_PI);
  return 1U << (static_cast<int>(turn * kSectors) % kSectors);
}

/// The sectors and their neighbours.
std::uint32_t widened(std::uint32_t sectors) {
  const std::uint32_t all = (1U << kSectors) - 1U;
  const std::uint32_t left = (sectors << 1) | (sectors >> (kSectors - 1));
  const std::uint32_t right = (sectors >> 1) | (sectors << (kSectors - 1));
  return (sectors | left | right) & all;
}

}  // namespace

LandmarkRecord& LandmarkRegistry::create(const Feature& feature, DescriptorPointer descriptor) {
  LandmarkRecord record;
  record.id = next_id_++;
  record.type = feature.type;
  record.classifier = std::make_shared<const std::string>(feature.classifier);
  if (descriptor != nullptr) record.descriptors.push_back(std::move(descriptor));
  records_.push_back(std::move(record));
  return records_.back();
}

const LandmarkRecord* LandmarkRegistry::find(LandmarkId id) const {
  const auto place = std::lower_bound(records_.begin(), records_.end(), id, before);
  return place != records_.end() && place->id == id ? &*place : nullptr;
}

LandmarkRecord* LandmarkRegistry::find(LandmarkId id) {
  const auto place = std::lower_bound(records_.begin(), records_.end(), id, before);
  return place != records_.end() && place->id == id ? &*place : nullptr;
}

void LandmarkRegistry::remove(LandmarkId id) {
  const auto place = std::lower_bound(records_.begin(), records_.end(), id, before);
  if (place != records_.end() && place->id == id) records_.erase(place);
}

void LandmarkRegistry::restore(LandmarkRecord record) {
  if (record.id < next_id_) {
    throw std::invalid_argument("landmark " + std::to_string(record.id) +
                                " is out of order or used already");
  }
  next_id_ = record.id + 1;
  records_.push_back(std::move(record));
}

void addSighting(LandmarkRecord& record,
                 const Eigen::Vector2d& robot_from_landmark_m,
                 const FeatureMatcher* matcher,
                 const DescriptorPointer& descriptor,
                 const AppearanceParameters& parameters) {
  record.seen_from |= sectorBit(robot_from_landmark_m);
  record.seen_within_m = std::max(record.seen_within_m, robot_from_landmark_m.norm());
  if (descriptor == nullptr ||
      record.descriptors.size() >= static_cast<std::size_t>(parameters.maximum_descriptors))
    return;
  if (record.descriptors.empty() || logLikelihoodRatio(matcher, descriptor, record.descriptors) <
                                        parameters.new_descriptor_below) {
    record.descriptors.push_back(descriptor);
  }
}

void addOrientation(LandmarkRecord& record,
                    double orientation_rad,
                    double variance_rad2,
                    const AppearanceParameters& parameters) {
  if (!(variance_rad2 < kUnobservedOrientation_rad2)) return;
  const double noise_rad2 =
      variance_rad2 + parameters.sighting_sigma_rad * parameters.sighting_sigma_rad;
  const double gain =
      record.orientation_variance_rad2 / (record.orientation_variance_rad2 + noise_rad2);
  record.orientation_rad = wrapAngle(record.orientation_rad +
                                     gain * wrapAngle(orientation_rad - record.orientation_rad));
  record.orientation_variance_rad2 *= 1.0 - gain;
}

bool knownFrom(const LandmarkRecord& record, const Eigen::Vector2d& robot_from_landmark_m) {
  return robot_from_landmark_m.norm() <= record.seen_within_m &&
         (widened(record.seen_from) & sectorBit(robot_from_landmark_m)) != 0;
}

}  // namespace ram_slam
