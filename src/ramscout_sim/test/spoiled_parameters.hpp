// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ramscout_sim::testing {

/// The message with which parameters that `spoil` has changed are refused; "accepted" if they are
/// not.
template <typename Parameters>
std::string refusalOfSpoiled(void (*spoil)(Parameters&)) {
  Parameters parameters;
  spoil(parameters);
  try {
    parameters.validate();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace ramscout_sim::testing
