// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include "ramscout_feature_detector/corner_matcher.hpp"
#include "ramscout_feature_detector/edge_matcher.hpp"

PLUGINLIB_EXPORT_CLASS(ramscout_feature_detector::CornerMatcher, ram_slam::FeatureMatcher)
PLUGINLIB_EXPORT_CLASS(ramscout_feature_detector::EdgeMatcher, ram_slam::FeatureMatcher)
