// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ramscout_bringup/recording.hpp"

namespace ramscout_bringup {

/// What the header stamps of one topic show, in the order of the recording.
struct StampReview {
  /// Messages whose stamp does not fit those before and after by more than 1 s, as indices.
  std::vector<std::size_t> stray;
  /// Where the clock was set back for good: a new drive begins at these indices, which rise.
  std::vector<std::size_t> reset;
  /// Median step between stamps that rise [s]; 0 if there are fewer than two.
  double period_s = 0.0;
  /// Longest step between the stamps in their order [s], and the stamp at its beginning.
  double longest_gap_s = 0.0;
  std::int64_t longest_gap_from_ns = 0;
};

/// Separates stray stamps from a clock that was set back: what is not part of the longest rising
/// sequence (Fredman 1975) and more than 1 s from its neighbours there is stray if it is one of
/// few in a row, else it belongs to another drive.
StampReview reviewStamps(const std::vector<std::int64_t>& stamps_ns);

/// Part of the different ones among some stamps; NaN if there is none.
double shareOfDifferent(std::vector<std::int64_t> stamps_ns);

/// Whether most stamps of a topic repeat, so that they are no times of measurement, and most of
/// those that the recorder gave do not.
bool shouldUseRecorders(const std::vector<std::int64_t>& stamps_ns,
                        const std::vector<std::int64_t>& recorders_ns);

/// The messages of one drive.
struct Drive {
  std::vector<std::size_t> order;  ///< indices by rising stamp, stray ones left out
  std::size_t stray_count = 0;
  double period_s = 0.0;  ///< median step between stamps; 0 if there are fewer than two
  std::vector<std::string> notes;
};

/// Selects a drive of a topic whose clock may have been set back.
/// \param part  which drive, from 1 \throws std::runtime_error naming the instants if there are
/// several drives and `part` is none of them
Drive selectDrive(const std::vector<std::int64_t>& stamps_ns,
                  const std::string& topic,
                  const std::optional<std::size_t>& part);

/// The scans of a drive that the options ask for (start_s, duration_s, max_rate_hz), in order.
/// \throws std::runtime_error if there is none
std::vector<std::size_t> selectScans(const Drive& drive,
                                     const std::vector<std::int64_t>& stamps_ns,
                                     const RecordingOptions& options);

}  // namespace ramscout_bringup
