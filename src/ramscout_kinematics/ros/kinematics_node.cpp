// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics_node.hpp"

#include <exception>

#include <diagnostic_msgs/DiagnosticArray.h>

#include "ram_slam/geometry/random.hpp"
#include "ram_slam/ros/conversions.hpp"

#include "service_conversions.hpp"

namespace ramscout_kinematics_ros {
namespace {

using ram_slam_ros::toNanoseconds;
using ramscout_kinematics::Added;
using Status = ram_slam_msgs::SampleStates::Response;

/// What each outcome of adding a sample is called, in the order of Added.
constexpr const char* kOutcomeNames[] = {"in order", "reordered",     "repeated",      "too late",
                                         "jump",     "discontinuity", "clock set back"};

/// Runs one of the verbatim services: these cannot carry a reason, so a refusal is a log line and a
/// failed call.
template <typename Answer>
bool answerOrFail(const char* service, const Answer& answer) {
  try {
    answer();
    return true;
  } catch (const ramscout_kinematics::OdometryUnavailable& error) {
    // A client ahead of the odometry will ask again.
    if (error.reason == ramscout_kinematics::Unavailable::kNotYetAvailable) {
      ROS_DEBUG_STREAM(service << " refused: " << error.what());
    } else {
      ROS_WARN_STREAM_THROTTLE(1.0, service << " refused: " << error.what());
    }
    return false;
  } catch (const std::exception& error) {
    ROS_WARN_STREAM_THROTTLE(1.0, service << " refused: " << error.what());
    return false;
  }
}

diagnostic_msgs::KeyValue keyValue(const std::string& key, const std::string& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = value;
  return entry;
}

}  // namespace

KinematicsNode::KinematicsNode(ram_parameters::ParameterReader& reader)
    : parameters_(ramscout_kinematics::readKinematicsParameters(reader)),
      kinematics_(parameters_),
      service_spinner_(1, &service_queue_) {
  diagnostics_ = node_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1);
  odometry_ = node_.subscribe("odom", 200, &KinematicsNode::onOdometry, this,
                              ros::TransportHints().tcpNoDelay());
  diagnostics_timer_ =
      node_.createWallTimer(ros::WallDuration(parameters_.node.diagnostics_period_s),
                            [this](const auto&) { publishDiagnostics(); });
  ros::NodeHandle private_node("~");
  private_node.setCallbackQueue(&service_queue_);
  services_ = {
      private_node.advertiseService("predict", &KinematicsNode::onPredict, this),
      private_node.advertiseService("predict_with_covariance",
                                    &KinematicsNode::onPredictWithCovariance, this),
      private_node.advertiseService("sample", &KinematicsNode::onSample, this),
      private_node.advertiseService("sample_states", &KinematicsNode::onSampleStates, this)};
  service_spinner_.start();
}

void KinematicsNode::onOdometry(const nav_msgs::Odometry& message) {
  ++samples_received_;
  try {
    const auto matches = [](const std::string& wanted, const std::string& got) {
      return wanted.empty() || wanted == got;
    };
    if (!matches(parameters_.node.odom_frame, message.header.frame_id) ||
        !matches(parameters_.node.base_frame, message.child_frame_id)) {
      throw std::invalid_argument("it is of '" + message.child_frame_id + "' in '" +
                                  message.header.frame_id + "', wanted '" +
                                  parameters_.node.base_frame + "' in '" +
                                  parameters_.node.odom_frame + "'");
    }
    const auto sample = toOdometrySample(message);
    const std::uint64_t drops_before = drops_.total();
    for (const auto& passed : guard_.add(sample.stamp_ns, sample, drops_).messages) use(passed);
    if (drops_.total() == drops_before) return;
    samples_rejected_ += drops_.total() - drops_before;
    ROS_WARN_STREAM_THROTTLE(
        parameters_.node.log_period_s,
        "Rejected odometry: " << toText(drops_.newest().reason) << ", " << drops_.newest().detail);
  } catch (const std::exception& error) {
    ++samples_rejected_;
    ROS_WARN_STREAM_THROTTLE(parameters_.node.log_period_s, "Rejected odometry: " << error.what());
  }
}

void KinematicsNode::use(const ramscout_kinematics::OdometrySample& sample) {
  const Added outcome = kinematics_.add(sample);
  ++samples_by_outcome_[static_cast<std::size_t>(outcome)];
  newest_arrival_ = ros::WallTime::now();
  if (outcome == Added::kDiscontinuity || outcome == Added::kClockSetBack) {
    ROS_WARN_STREAM("Odometry at " << ram_slam_ros::toTime(sample.stamp_ns) << ": "
                                   << kOutcomeNames[static_cast<std::size_t>(outcome)]);
  }
}

bool KinematicsNode::onPredict(ram_slam_msgs::PredictState::Request& request,
                               ram_slam_msgs::PredictState::Response& response) {
  return answerOrFail("predict", [&] {
    response.state = toFloats(kinematics_.predict(
        toState(request.state), toNanoseconds(request.from), toNanoseconds(request.to)));
  });
}

bool KinematicsNode::onPredictWithCovariance(
    ram_slam_msgs::PredictStateWithCovariance::Request& request,
    ram_slam_msgs::PredictStateWithCovariance::Response& response) {
  return answerOrFail("predict_with_covariance", [&] {
    ramscout_kinematics::StateWithCovariance start;
    start.state = toState(request.state);
    start.covariance = toCovariance(request.cov, start.state.size());
    const auto end = kinematics_.predictWithCovariance(start, toNanoseconds(request.from),
                                                       toNanoseconds(request.to));
    response.state = toFloats(end.state);
    response.cov = toFloats(end.covariance);
  });
}

bool KinematicsNode::onSample(ram_slam_msgs::SampleState::Request& request,
                              ram_slam_msgs::SampleState::Response& response) {
  return answerOrFail("sample", [&] {
    // A seed of its own for every call: the stream of the node's seed, at the number of the call.
    ram_slam::Random seeds(static_cast<std::uint64_t>(parameters_.node.seed), samples_drawn_++);
    const Eigen::MatrixXd state = toState(request.state);
    response.state = toFloats(
        kinematics_.sample(state, toNanoseconds(request.from), toNanoseconds(request.to), seeds()));
  });
}

bool KinematicsNode::onSampleStates(ram_slam_msgs::SampleStates::Request& request,
                                    ram_slam_msgs::SampleStates::Response& response) {
  try {
    const Eigen::MatrixXd samples =
        kinematics_.sample(toStates(request.states, request.count,
                                    static_cast<std::uint32_t>(parameters_.node.max_states)),
                           toNanoseconds(request.from), toNanoseconds(request.to), request.seed);
    response.states.assign(samples.data(), samples.data() + samples.size());
    response.status = Status::SUCCESS;
  } catch (const InvalidRequest& error) {
    response.status = error.status;
    response.message = error.what();
  } catch (const ramscout_kinematics::OdometryUnavailable& error) {
    response.status = toStatus(error.reason);
    response.message = error.what();
  } catch (const std::invalid_argument& error) {  // states are checked: it is the interval
    response.status = Status::INVALID_INTERVAL;
    response.message = error.what();
  }
  return true;
}

diagnostic_msgs::DiagnosticStatus KinematicsNode::diagnose(std::uint64_t received,
                                                           std::uint64_t unused) const {
  const auto& limits = parameters_.node;
  diagnostic_msgs::DiagnosticStatus status;
  status.name = ros::this_node::getName() + ": odometry";
  status.hardware_id = "none";
  status.level = diagnostic_msgs::DiagnosticStatus::OK;
  status.message = "odometry arrives";
  const double silence_s = newest_arrival_.isZero()
                               ? limits.silence_error_s + 1.0
                               : (ros::WallTime::now() - newest_arrival_).toSec();
  const auto warnOrError = [](bool is_error) {
    return is_error ? diagnostic_msgs::DiagnosticStatus::ERROR
                    : diagnostic_msgs::DiagnosticStatus::WARN;
  };
  if (unused > 0) {
    status.level = warnOrError(2 * unused > received);
    status.message = "odometry rejected";
  } else if (silence_s > limits.silence_warning_s) {
    status.level = warnOrError(silence_s > limits.silence_error_s);
    status.message = newest_arrival_.isZero() ? "no odometry yet" : "no odometry for a while";
  }
  const double rate_hz = static_cast<double>(received) / limits.diagnostics_period_s;
  status.values = {keyValue("rate [1/s]", std::to_string(rate_hz)),
                   keyValue("seconds since the newest", std::to_string(silence_s)),
                   keyValue("rejected", std::to_string(samples_rejected_))};
  for (std::size_t i = 0; i < samples_by_outcome_.size(); ++i) {
    status.values.push_back(keyValue(kOutcomeNames[i], std::to_string(samples_by_outcome_[i])));
  }
  return status;
}

void KinematicsNode::publishDiagnostics() {
  const std::uint64_t unused = samples_rejected_ +
                               samples_by_outcome_[static_cast<std::size_t>(Added::kTooLate)] +
                               samples_by_outcome_[static_cast<std::size_t>(Added::kJump)];
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.push_back(
      diagnose(samples_received_ - diagnosed_received_, unused - diagnosed_unused_));
  diagnosed_received_ = samples_received_;
  diagnosed_unused_ = unused;
  diagnostics_.publish(message);
}

}  // namespace ramscout_kinematics_ros
