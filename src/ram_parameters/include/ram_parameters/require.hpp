// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ram_parameters {

/// For the validate() of parameters: names the parameter, its value and what it must be.
/// \throws std::invalid_argument unless `condition` holds
inline void require(bool condition,
                    const std::string& parameter,
                    double value,
                    const std::string& bound) {
  if (condition) return;
  throw std::invalid_argument(parameter + " must be " + bound + ", got " + std::to_string(value));
}

/// \throws std::invalid_argument unless `value` > 0
inline void requirePositive(const std::string& parameter, double value) {
  require(value > 0.0, parameter, value, "> 0");
}

}  // namespace ram_parameters
