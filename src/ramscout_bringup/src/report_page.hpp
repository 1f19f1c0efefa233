// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace ramscout_bringup {

/// src/report.html
extern const char* const kReportPage;
/// Of this package.
extern const char* const kVersion;

}  // namespace ramscout_bringup
