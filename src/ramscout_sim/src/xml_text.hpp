// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace ramscout_sim {

/// How deep elements are nested in a text that should be XML; counted no farther than to 101.
int depthOfXml(const std::string& text);

/// Parsers of URDF call themselves for each element within another and run out of stack. Robots
/// need a depth of less than ten. \throws std::invalid_argument if it is more than 100
void requireShallowXml(const std::string& text);

/// The text of a file. \throws std::runtime_error naming it if it cannot be opened
std::string readXml(const std::string& path);

}  // namespace ramscout_sim
