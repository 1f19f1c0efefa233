// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "ramscout_bringup/results.hpp"

namespace ramscout_bringup {

/// A picture of a run as a PNG file's content: the map (walls black, floor white, unknown grey),
/// landmarks with their 1-sigma ellipses, the estimated path, the true one if there is one (aligned
/// with the estimate as compareWithTruth() does), a scale bar and a legend. An empty map gives a
/// picture of the paths alone.
std::string drawPicture(const Results& results);

}  // namespace ramscout_bringup
