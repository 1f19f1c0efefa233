// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics_node.hpp"

#include <exception>

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
    // A client ahead of the odometry will ask again; that there is none is in the diagnostics. At
    // the start a client may have readings from before the odometry, which it counts as left out.
    if (error.reason == ramscout_kinematics::Unavailable::kNotYetAvailable ||
        error.reason == ramscout_kinematics::Unavailable::kBeforeFirst ||
        error.reason == ramscout_kinematics::Unavailable::kNoOdometry) {
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

}  // namespace

KinematicsNode::KinematicsNode(ram_parameters::ParameterReader& reader)
    : parameters_(ramscout_kinematics::readKinematicsParameters(reader)),
      kinematics_(parameters_),
      odometry_(node_.subscribe(
          "odom", 200, &KinematicsNode::onOdometry, this, ros::TransportHints().tcpNoDelay())),
      diagnostics_(ram_slam::Link::kKinematics, "odometry", [this] { return report(); }),
      odometry_input_(
          diagnostics_.watch<nav_msgs::Odometry>(odometry_, ram_slam_ros::refinedOdometryInput())),
      service_spinner_(1, &service_queue_) {
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

void KinematicsNode::onOdometry(const ros::MessageEvent<const nav_msgs::Odometry>& event) {
  const nav_msgs::Odometry& message = *event.getMessage();
  diagnostics_.arrived(odometry_input_, event);
  messages_.add(event.getPublisherName(), message.header.seq);
  const std::uint64_t drops_before = drops_.total();
  try {
    const auto& frames = parameters_.node;
    ram_slam_ros::requireFrames(
        message, frames.odom_frame.empty() ? message.header.frame_id : frames.odom_frame,
        frames.base_frame.empty() ? message.child_frame_id : frames.base_frame);
    auto sample = toOdometrySample(message);
    sample.is_restart = isRestart(event.getPublisherName(), message.header.seq);
    for (const auto& passed : guard_.add(sample.stamp_ns, sample, drops_).messages) use(passed);
  } catch (const std::exception& error) {
    drops_.add(ram_slam::DropReason::kInvalidOdometry, toNanoseconds(message.header.stamp),
               error.what());
  }
  diagnostics_.refusedIfDropped(odometry_input_, drops_, drops_before);
  drop_log_.log(drops_, odometry_.getTopic());
}

bool KinematicsNode::isRestart(const std::string& publisher, std::uint32_t number) {
  const auto [last, is_first] = newest_numbers_.emplace(publisher, number);
  const bool is_restart = !is_first && number < last->second;
  last->second = number;
  if (is_restart) {
    ROS_WARN_STREAM(publisher << " was started again: what the robot drove in between is taken "
                                 "from tf by the estimator");
  }
  return is_restart;
}

void KinematicsNode::use(const ramscout_kinematics::OdometrySample& sample) {
  const Added outcome = kinematics_.add(sample);
  const char* name = kOutcomeNames[static_cast<std::size_t>(outcome)];
  ++samples_by_outcome_[static_cast<std::size_t>(outcome)];
  if (outcome == Added::kTooLate || outcome == Added::kJump) {
    drops_.add(outcome == Added::kJump ? ram_slam::DropReason::kInvalidOdometry
                                       : ram_slam::DropReason::kNotLater,
               sample.stamp_ns, name);
  } else if (outcome == Added::kDiscontinuity || outcome == Added::kClockSetBack) {
    ROS_WARN_STREAM("Odometry at " << ram_slam_ros::toTime(sample.stamp_ns) << ": " << name);
  }
}

ram_slam_ros::NodeDiagnostics::Report KinematicsNode::report() const {
  ram_slam_ros::NodeDiagnostics::Report report;
  report.state = "odometry arrives";
  report.drops = drops_;
  report.messages = messages_;
  for (std::size_t i = 0; i < samples_by_outcome_.size(); ++i)
    report.values.emplace_back(kOutcomeNames[i], static_cast<double>(samples_by_outcome_[i]));
  return report;
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

}  // namespace ramscout_kinematics_ros
