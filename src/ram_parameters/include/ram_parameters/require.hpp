// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ram_parameters {

/// For the validate() of parameters: says which one has which value, and what it must be.
/// \throws std::invalid_argument unless `condition` holds
inline void require(bool condition,
                    const std::string& parameter,
                    double value,
                    const std::string& bound) {
  if (condition) return;
  throw std::invalid_argument(parameter + " must be " + bound + ", got " + std::to_string(value));
}

}  // namespace ram_parameters
