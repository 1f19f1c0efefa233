// SPDX-License-Identifier: BSD-3-Clause
// Round trips of the kinematics services over the loopback while odometry arrives at 100 Hz;
// services.launch runs it.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <nav_msgs/Odometry.h>
#include <ram_slam_msgs/PredictStateWithCovariance.h>
#include <ram_slam_msgs/SampleState.h>
#include <ram_slam_msgs/SampleStates.h>
#include <ros/ros.h>

namespace {

constexpr double kStartS = 1000.0;
constexpr double kOdometryPeriodS = 0.01;

/// Publishes a straight drive in real time; the newest stamp is what requests ask about.
class Robot {
public:
  Robot() : publisher_(node_.advertise<nav_msgs::Odometry>("odom", 100)) {
    while (ros::ok() && publisher_.getNumSubscribers() == 0) ros::WallDuration(0.01).sleep();
    for (int i = 0; i < 100; ++i) publishNext();
    ros::WallDuration(0.2).sleep();
    thread_ = std::thread([this] {
      while (!stopping_) {
        publishNext();
        ros::WallDuration(kOdometryPeriodS).sleep();
      }
    });
  }
  ~Robot() {
    stopping_ = true;
    thread_.join();
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  ros::Time newest() const { return ros::Time(kStartS + kOdometryPeriodS * newest_); }

private:
  void publishNext() {
    nav_msgs::Odometry message;
    message.header.stamp = ros::Time(kStartS + kOdometryPeriodS * (newest_ + 1));
    message.header.frame_id = "odom";
    message.child_frame_id = "base_link";
    message.pose.pose.position.x = 0.5 * kOdometryPeriodS * (newest_ + 1);
    message.pose.pose.orientation.w = 1.0;
    publisher_.publish(message);
    ++newest_;
  }

  ros::NodeHandle node_;
  ros::Publisher publisher_;
  std::atomic<int> newest_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

template <typename Service>
void call(benchmark::State& state, const char* name, typename Service::Request request) {
  const Robot robot;
  ros::NodeHandle node;
  ros::ServiceClient client = node.serviceClient<Service>(name, true);
  typename Service::Response response;
  std::vector<double> round_trips_us;
  for ([[maybe_unused]] const auto iteration : state) {
    request.to = robot.newest() - ros::Duration(0.02);
    request.from = request.to - ros::Duration(0.1);
    const auto start = std::chrono::steady_clock::now();
    if (!client.call(request, response)) {
      state.SkipWithError("the call failed");
      break;
    }
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    round_trips_us.push_back(took.count());
  }
  std::sort(round_trips_us.begin(), round_trips_us.end());
  const auto percentile = [&round_trips_us](double share) {
    if (round_trips_us.empty()) return 0.0;
    return round_trips_us[static_cast<std::size_t>(share *
                                                   static_cast<double>(round_trips_us.size() - 1))];
  };
  state.counters["median_us"] = percentile(0.5);
  state.counters["p99_us"] = percentile(0.99);
}

void sampleStates(benchmark::State& state) {
  ram_slam_msgs::SampleStates::Request request;
  request.count = static_cast<std::uint32_t>(state.range(0));
  request.states.assign(3 * request.count, 1.0);
  call<ram_slam_msgs::SampleStates>(state, "kinematics/sample_states", request);
}
BENCHMARK(sampleStates)->Arg(100)->Arg(1000)->UseRealTime()->Unit(benchmark::kMicrosecond);

void sampleState(benchmark::State& state) {
  ram_slam_msgs::SampleState::Request request;
  request.state.assign(3, 1.0F);
  call<ram_slam_msgs::SampleState>(state, "kinematics/sample", request);
}
BENCHMARK(sampleState)->UseRealTime()->Unit(benchmark::kMicrosecond);

void predictWithCovariance(benchmark::State& state) {
  ram_slam_msgs::PredictStateWithCovariance::Request request;
  request.state.assign(6, 1.0F);
  request.cov.assign(36, 0.0F);
  call<ram_slam_msgs::PredictStateWithCovariance>(state, "kinematics/predict_with_covariance",
                                                  request);
}
BENCHMARK(predictWithCovariance)->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "services_benchmark");
  const ros::NodeHandle node;
  ros::service::waitForService("kinematics/sample_states");
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
