// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include "ramscout_feature_detector/corner_matcher.hpp"

PLUGINLIB_EXPORT_CLASS(ramscout_feature_detector::CornerMatcher, ram_slam::FeatureMatcher)
