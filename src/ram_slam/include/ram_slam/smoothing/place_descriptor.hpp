// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "ram_slam/scan_matching/surface_scan.hpp"

namespace ram_slam {

/// The shape of what a scan saw: the share of all pairs of its points by their distance and by the
/// angle between their walls (parallel or crossing). It is the same from wherever the same walls
/// are seen, in any heading (the D2 shape distribution of Osada et al., ACM TOG 2002, with
/// normals).
using PlaceDescriptor = std::vector<float>;

/// \param max_range_m  points farther away do not count
/// \return empty if fewer than two points lie on walls
PlaceDescriptor describePlace(const SurfaceScan& surfaces, double max_range_m);

/// The share that two descriptors have in common, 0 .. 1; 0 if one is empty.
double likeness(const PlaceDescriptor& a, const PlaceDescriptor& b);

}  // namespace ram_slam
