// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace ramscout_bringup {

/// What `read()` returns. A std::runtime_error or std::invalid_argument from there whose text does
/// not contain the path gets it in front: a user with many files must know which one is meant.
template <typename Read>
auto namingFile(const std::string& path, const Read& read) {
  const auto lacks_path = [&path](const std::exception& error) {
    return std::string(error.what()).find(path) == std::string::npos;
  };
  try {
    return read();
  } catch (const std::runtime_error& error) {
    if (!lacks_path(error)) throw;
    throw std::runtime_error(path + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    if (!lacks_path(error)) throw;
    throw std::invalid_argument(path + ": " + error.what());
  }
}

}  // namespace ramscout_bringup
