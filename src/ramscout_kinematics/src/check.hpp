// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <stdexcept>

namespace ramscout_kinematics {

/// \throws std::invalid_argument "NAME must be BOUND, got VALUE" unless `fulfilled`
template <typename Value>
void check(bool fulfilled, const char* name, const Value& value, const char* bound) {
  if (fulfilled) return;
  std::ostringstream message;
  message << name << " must be " << bound << ", got " << value;
  throw std::invalid_argument(message.str());
}

}  // namespace ramscout_kinematics
