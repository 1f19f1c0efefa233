// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "ramscout_bringup/recording.hpp"

namespace ramscout_bringup_ros {

/// The options of the command line that say how to read a recording.
/// \param options  filled in when `app` parses; outlives it
void addOptions(CLI::App& app, ramscout_bringup::RecordingOptions& options);

}  // namespace ramscout_bringup_ros
