// SPDX-License-Identifier: BSD-3-Clause
#include "ram_slam/ekf_slam/ekf_slam_parameters.hpp"

#include "ram_slam/fast_slam/read_filter_parameters.hpp"

namespace ram_slam {

const ram_parameters::ParameterTable<EkfSlamParameters>& EkfSlamParameters::table() {
  using P = EkfSlamParameters;
  static const auto table =
      ram_parameters::ParameterTable<P>()
          .add("max_landmarks", &P::max_landmarks, "", ram_parameters::within(1, 10000),
               "With so many landmarks no new one is created. Memory and time of an update grow "
               "with its square: 1,000 take 40 MB and about 15 ms.")
          .include(&P::common, FastSlamParameters::landmarkTable());
  return table;
}

EkfSlamParameters readEkfSlamParameters(ram_parameters::ParameterReader& reader) {
  return readFilterParameters<EkfSlamParameters>(reader);
}

}  // namespace ram_slam
