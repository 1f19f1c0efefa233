// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_bringup/carmen_log.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>

#include <boost/iostreams/copy.hpp>
#include <boost/iostreams/filter/gzip.hpp>
#include <boost/iostreams/filter/lzma.hpp>
#include <boost/iostreams/filtering_stream.hpp>
#include <gmock/gmock.h>

namespace ramscout_bringup {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class CarmenLogTest : public ::testing::Test {
protected:
  ~CarmenLogTest() override { std::remove(path().c_str()); }

  static std::string path() {
    return ::testing::TempDir() + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
           ".clf";
  }

  static CarmenLog read(const std::string& text) {
    std::ofstream(path(), std::ios::binary) << text;
    return readCarmenLog(path());
  }

  template <typename Compressor>
  static std::string pack(const std::string& text, const Compressor& compressor) {
    std::string packed;
    boost::iostreams::filtering_ostream out;
    out.push(compressor);
    out.push(boost::iostreams::back_inserter(packed));
    out << text;
    boost::iostreams::close(out);
    return packed;
  }

  /// A FLASER line of two readings, laser 0.1 m behind the base.
  static std::string twoReadings(const std::string& ranges, const std::string& stamp) {
    return "FLASER 2 " + ranges + " 0.9 2.0 0.0 1.0 2.0 0.0 " + stamp + " host 7.5\n";
  }
};

TEST_F(CarmenLogTest, ReadsALaserLineFieldByField) {
  const CarmenLog log = read(
      "# a comment\nPARAM robot_frontlaser_offset 0.1\nODOM 9 9 9 0 0 0 1.0 host 0.1\n"
      "FLASER 3 1.5 2.25 3.00 1.0 2.1 1.5707963267948966 1.0 2.0 1.5707963267948966 "
      "1071078718.123456 host 0.2\n"
      "FLASER 3 1.5 2.25 3.00 1.0 3.1 1.5707963267948966 1.0 3.0 1.5707963267948966 1071078719 "
      "host 0.3\n");
  ASSERT_THAT(log.scans, SizeIs(2));
  EXPECT_THAT(log.scans[0].ranges_m, ElementsAre(1.5F, 2.25F, 3.0F));
  EXPECT_EQ(log.scans[0].stamp_ns, 1071078718123456000);
  EXPECT_EQ(log.scans[1].stamp_ns, 1071078719000000000);
  EXPECT_NEAR(log.scans[0].angle_min_rad, -M_PI_2, 1e-12);
  EXPECT_NEAR(log.scans[0].angle_increment_rad, M_PI_2, 1e-12);
  ASSERT_THAT(log.odometry, SizeIs(2));
  EXPECT_EQ(log.odometry[1].stamp_ns, log.scans[1].stamp_ns);
  EXPECT_DOUBLE_EQ(log.odometry[1].pose.y_m, 3.0);
  EXPECT_TRUE(log.mount_is_known);
  EXPECT_NEAR(log.base_from_laser.x_m, 0.1, 1e-12);
  EXPECT_NEAR(log.base_from_laser.y_m, 0.0, 1e-12);
  EXPECT_EQ(log.damaged_line_count, 0u);
}

TEST_F(CarmenLogTest, ReadsTheGeometryThatARobotLaserLineCarries) {
  const CarmenLog log = read(
      "ROBOTLASER1 0 -1.2 2.4 0.8 30.0 0.01 0 4 1.0 2.0 30.0 0.0 1 77 "
      "0.5 0.0 0.0 0.3 0.0 0.0 0.1 0.2 0.3 0.4 0.5 12.5 host 3.0\n");
  ASSERT_THAT(log.scans, SizeIs(1));
  EXPECT_EQ(log.scans[0].stamp_ns, 12500000000);
  EXPECT_NEAR(log.scans[0].angle_min_rad, -1.2, 1e-12);
  EXPECT_NEAR(log.scans[0].angle_increment_rad, 0.8, 1e-12);
  EXPECT_THAT(log.scans[0].ranges_m, ElementsAre(1.0F, 2.0F, kInfinity, -kInfinity));
  EXPECT_NEAR(log.base_from_laser.x_m, 0.2, 1e-12);
}

TEST_F(CarmenLogTest, SpreadsReadingsOverHalfATurnByCarmensConvention) {
  const auto increment_of = [](int count) {
    std::string line = "FLASER " + std::to_string(count);
    for (int i = 0; i < count; ++i) line += " 1.0";
    return read(line + " 0 0 0 0 0 0 1.0 h 1.0\n").scans[0].angle_increment_rad * 180.0 / M_PI;
  };
  EXPECT_NEAR(increment_of(180), 1.0, 1e-12);
  EXPECT_NEAR(increment_of(181), 1.0, 1e-12);
  EXPECT_NEAR(increment_of(360), 0.5, 1e-12);
  EXPECT_NEAR(increment_of(361), 0.5, 1e-12);
}

TEST_F(CarmenLogTest, FindsTheNoReturnCodeInTheLogItself) {
  std::string text;
  for (int i = 0; i < 100; ++i) {
    text += twoReadings(i % 2 == 0 ? "81.91 3.0" : std::to_string(6.0 + 0.3 * i) + " 81.83",
                        std::to_string(10 + i));
  }
  const CarmenLog log = read(text);
  ASSERT_TRUE(log.no_return_m.has_value());
  EXPECT_EQ(std::lround(*log.no_return_m), 82);
  EXPECT_THAT(log.scans[0].ranges_m, ElementsAre(kInfinity, 3.0F));
  EXPECT_EQ(log.scans[99].ranges_m[1], kInfinity);
  EXPECT_FLOAT_EQ(log.scans[99].ranges_m[0], 35.7F);
  EXPECT_LT(log.scans[0].range_max_m, 81.83F);
}

TEST_F(CarmenLogTest, TakesFarWallsForWallsWhenThereIsNoCode) {
  std::string text;
  for (int i = 0; i < 100; ++i) {
    text += twoReadings(std::to_string(20.0 + 0.01 * (i % 7)) + " 15.0", std::to_string(10 + i));
  }
  const CarmenLog log = read(text);
  EXPECT_FALSE(log.no_return_m.has_value());
  EXPECT_FLOAT_EQ(log.scans[3].ranges_m[0], 20.03F);
}

TEST_F(CarmenLogTest, PutsScansInStampOrderAndDropsASecondOneOfTheSameStamp) {
  const CarmenLog log = read(twoReadings("1 1", "30.0") + twoReadings("2 2", "10.0") +
                             twoReadings("3 3", "30.0") + twoReadings("4 4", "20.0"));
  ASSERT_THAT(log.scans, SizeIs(3));
  EXPECT_EQ(log.scans[0].ranges_m[0], 2.0F);
  EXPECT_EQ(log.scans[1].ranges_m[0], 4.0F);
  EXPECT_EQ(log.scans[2].ranges_m[0], 1.0F);
  EXPECT_EQ(log.duplicate_scan_count, 1u);
}

TEST_F(CarmenLogTest, CountsDamagedLinesAndReadsOn) {
  const CarmenLog log = read(
      "FLASER 3 1.0 2.0\nFLASER 2 1.0 x 0 0 0 0 0 0 1.0 h 1.0\nFLASER -1\nFLASER 99999999999\n" +
      twoReadings("1 1", "nan") + twoReadings("1 1", "-5") + twoReadings("1 1", "5.0"));
  EXPECT_THAT(log.scans, SizeIs(1));
  EXPECT_EQ(log.damaged_line_count, 6u);
}

TEST_F(CarmenLogTest, HasNoOdometryIfTheWheelsNeverMove) {
  EXPECT_THAT(read(twoReadings("1 1", "1.0") + twoReadings("1 1", "2.0")).odometry, IsEmpty());
}

TEST_F(CarmenLogTest, DoesNotInventAMountWhereLaserPosesWereCorrected) {
  std::string text;
  for (int i = 0; i < 9; ++i) {
    text += "FLASER 2 1 1 " + std::to_string(i * i) + " 0 0 " + std::to_string(i) + " 0 0 " +
            std::to_string(i + 1) + " h 1\n";
  }
  const CarmenLog log = read(text);
  EXPECT_FALSE(log.mount_is_known);
  EXPECT_EQ(log.base_from_laser.x_m, 0.0);
}

TEST_F(CarmenLogTest, PackedLogsReadAsThePlainOne) {
  const std::string text = twoReadings("1.25 3.5", "10.0") + twoReadings("2 2", "11.0");
  for (const std::string& packed : {pack(text, boost::iostreams::gzip_compressor()),
                                    pack(text, boost::iostreams::lzma_compressor())}) {
    const CarmenLog log = read(packed);
    ASSERT_THAT(log.scans, SizeIs(2));
    EXPECT_THAT(log.scans[0].ranges_m, ElementsAre(1.25F, 3.5F));
  }
}

TEST_F(CarmenLogTest, NamesTheFileItCannotUse) {
  const auto message_of = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message_of([] { readCarmenLog("/nowhere/x.clf"); }),
              HasSubstr("/nowhere/x.clf cannot be read"));
  EXPECT_THAT(message_of([] { read("PARAM a b\n"); }), HasSubstr("has no readable FLASER"));
  const std::string packed = pack(twoReadings("1 1", "1.0"), boost::iostreams::gzip_compressor());
  EXPECT_THAT(message_of([&] { read(packed.substr(0, packed.size() / 2)); }),
              HasSubstr("is damaged"));
}

}  // namespace
}  // namespace ramscout_bringup
