// SPDX-License-Identifier: BSD-3-Clause
// The elements of a world file. `name` is what errors call the element: file, list, number. All
// throw std::invalid_argument naming element, key and reason.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "ram_parameters/parameter_reader.hpp"
#include "ramscout_sim/world.hpp"

namespace ramscout_sim {

/// A list of exactly `size` numbers within 100 km.
std::vector<double> readVector(ram_parameters::ParameterReader& reader,
                               const std::string& name,
                               const std::string& key,
                               std::size_t size);

/// The waypoints or the appointments of an element: a list of pairs.
std::vector<Eigen::Vector2d> readPairs(const YAML::Node& list, const std::string& name);

void requireIn(const std::string& name, const char* key, double value, double low, double high);

Material readMaterial(ram_parameters::ParameterReader& reader, const std::string& name);

Solid readWall(ram_parameters::ParameterReader& reader, const std::string& name);
Solid readBox(ram_parameters::ParameterReader& reader, const std::string& name);
Solid readRamp(ram_parameters::ParameterReader& reader, const std::string& name);
Solid readCylinder(ram_parameters::ParameterReader& reader, const std::string& name);

}  // namespace ramscout_sim
