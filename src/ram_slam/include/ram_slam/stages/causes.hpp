// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace ram_slam {

/// Parts of the way from the clock to the map, in the order in which each needs those before it.
enum class Link { kClock, kScan, kTf, kOdometry, kKinematics, kFeatures, kPose, kMap };
/// In the order of the way.
std::vector<Link> allLinks();
/// One word, such as "kinematics".
std::string toText(Link link);

/// The values are those of the levels in diagnostic_msgs/DiagnosticStatus.
enum class Severity { kOk = 0, kWarning = 1, kError = 2 };

/// Why a node does not do what it should, and what to do about it.
struct Cause {
  Link link = Link::kScan;
  Severity severity = Severity::kError;
  std::string name;  ///< which kind of cause it is: "wrong topic"
  std::string text;  ///< one line
};

/// Of no message, or no transform, yet.
constexpr double kNever_s = std::numeric_limits<double>::infinity();

/// What a node can see of one of its inputs. All durations are wall time but those of stamps.
struct InputFacts {
  Link link = Link::kScan;
  std::string content;   ///< what comes on it: "scans"
  std::string topic;     ///< as it is resolved: "/front/scan"
  std::string argument;  ///< by which the topic is set: "scan", as in scan:=/front/scan
  std::string source;    ///< what usually publishes it: "the driver of the lidar"
  std::string type;      ///< of its messages
  bool is_needed = true;
  /// Comes now and then only, so that silence means nothing once it has a publisher.
  bool is_rare = false;

  std::vector<std::string> publishers;  ///< that the master knows
  std::vector<std::string> dead;        ///< of these, the ones that refuse connections
  std::string published_type;           ///< as the master has it; empty: not known
  std::vector<std::string> elsewhere;   ///< other topics of the type: "/base_scan of /lidar"

  double age_s = kNever_s;   ///< since the newest message came
  double interval_s = 0.0;   ///< usual time between two
  double stamp_age_s = 0.0;  ///< clock minus stamp when it came, the nearest to zero of a second
  std::string newest_publisher;  ///< of the newest message
  std::string refusal;           ///< why none of the last second was used; empty: some were
};

/// What a node can see of a transform that it needs.
struct TransformFacts {
  Link link = Link::kTf;
  std::string parent;
  std::string child;
  std::string parent_parameter;  ///< that names the frame; empty: none does
  std::string child_parameter;
  std::string remedy;              ///< who should publish it: "start robot_state_publisher"
  double missing_s = 0.0;          ///< since when it is needed and not there; 0: it is there
  double stamp_age_s = 0.0;        ///< clock minus its newest stamp; 0: it is static or missing
  bool parent_exists = false;      ///< in tf
  std::vector<std::string> above;  ///< frames above the child in tf, nearest first
  std::vector<std::string> below;  ///< frames directly below the parent in tf
};

/// All that decides how a node does.
struct NodeFacts {
  Link link = Link::kScan;  ///< that the node is
  double running_s = 0.0;
  bool is_simulated_time = false;
  bool has_clock = true;          ///< a time has come, if it is simulated
  double clock_standing_s = 0.0;  ///< since when simulated time has not moved
  double clock_speed = 1.0;       ///< seconds of the clock in a second of wall time
  std::vector<InputFacts> inputs;
  std::vector<TransformFacts> transforms;
  std::vector<Cause> own;  ///< what the node has found itself
  std::string output;      ///< topic that follows each needed input; empty: none does
  double output_age_s = kNever_s;
  double output_patience_s = 2.0;  ///< after the inputs
};

/// Why a node does not do what it should: the first one first, nothing if it does. Each cause is
/// known a second after it began, or after the node has started.
class CauseFinder {
public:
  static std::vector<Cause> find(const NodeFacts& facts);

private:
  static constexpr double kPatience_s = 1.0;       ///< connections and first messages take that
  static constexpr double kUsualIntervals = 3.0;   ///< one or two messages may be missing
  static constexpr double kMostStampAge_s = 1.0;   ///< of slow drivers and networks
  static constexpr double kOtherClock_s = 3600.0;  ///< no clock that is set at all is that far off

  static double silencePatience_s(const InputFacts& input);
  static bool isSilent(const InputFacts& input);
  static void checkInput(const NodeFacts& node,
                         const InputFacts& input,
                         std::vector<Cause>& causes);
  static std::string nameOfSilence(const InputFacts& input);
  static std::string textOfSilence(const std::string& name, const InputFacts& input);
  static std::string textOfStamps(const NodeFacts& node, const InputFacts& input);
  static void checkStamps(const NodeFacts& node,
                          const InputFacts& input,
                          std::vector<Cause>& causes);
  static void checkTransform(const NodeFacts& node,
                             const TransformFacts& transform,
                             std::vector<Cause>& causes);
  static void checkOutput(const NodeFacts& node, std::vector<Cause>& causes);
};

/// Decides which causes are worth a line of the log: each once, when it has lasted for a while, and
/// again only if it was gone in between. Those that differ by numbers only are one.
class CauseLog {
public:
  /// \param now_s  wall time since the node started
  /// \return the causes to log now
  std::vector<Cause> update(const std::vector<Cause>& causes, double now_s);

private:
  static constexpr double kAtStart_s = 3.0;    ///< what began before ...
  static constexpr double kStarting_s = 10.0;  ///< ... may be over by then: other nodes start, too
  static constexpr double kLasting_s = 2.0;    ///< what began later is logged when it lasts
  static constexpr double kGone_s = 10.0;      ///< one that comes and goes is one

  struct Entry {
    std::string key;
    double first_s = 0.0;
    double newest_s = 0.0;
    bool is_logged = false;
  };
  std::vector<Entry> entries_;
};

}  // namespace ram_slam
