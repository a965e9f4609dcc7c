#include "robot/ros2/state_publisher.hpp"

#include <fmt/format.h>
#include <ros2_messages.h>

#include "robot/ros2/diagnostics.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::ros2 {
namespace {

constexpr std::int64_t kModeEvery_us = 100'000, kDiagnosticsEvery_us = 1'000'000;
constexpr const char *kJoint = "needle", *kFrame = "scanner_ras";

// The C structs point to text that only has to live until it was written; they do not change it.
char* text(const std::string& value) {
  return const_cast<char*>(value.c_str());
}
char* text(const char* value) {
  return const_cast<char*>(value);
}

std_msgs_msg_dds__Header_ header(std::int64_t wall_ns, const char* frame) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return {{static_cast<std::int32_t>(wall_ns / kSecond_ns), static_cast<std::uint32_t>(wall_ns % kSecond_ns)},
          text(frame)};
}

bool is_due(std::int64_t& last_us, std::int64_t now_us, std::int64_t every_us) {
  if (last_us != 0 && now_us - last_us < every_us) return false;
  last_us = now_us;
  return true;
}

// From LPS millimetres to RAS metres: half a turn about z.
geometry_msgs_msg_dds__Pose_ tip_pose(const RigidTransform& X_SR, double depth_mm) {
  const Point tip = ras_from_lps(X_SR * Point(0.0, 0.0, depth_mm)) * 1e-3;
  const Eigen::Quaterniond half_turn(0.0, 0.0, 0.0, 1.0);
  const Eigen::Quaterniond turn = (half_turn * Eigen::Quaterniond(X_SR.linear())).normalized();
  return {{tip.x(), tip.y(), tip.z()}, {turn.x(), turn.y(), turn.z(), turn.w()}};
}

}  // namespace

StatePublisher::StatePublisher(const RosSettings& settings, std::uint32_t robot)
    : node_(settings, "biopsy"),
      hardware_(fmt::format("robot {}", robot)),
      joints_(node_.advertise("/joint_states", sensor_msgs_msg_dds__JointState__desc)),
      depth_(node_.advertise("/needle/depth", std_msgs_msg_dds__Float64__desc)),
      pose_(node_.advertise("/needle/state/pose", geometry_msgs_msg_dds__PoseStamped__desc)),
      mode_(node_.advertise("/supervisor/state", std_msgs_msg_dds__String__desc)),
      diagnostics_(node_.advertise("/diagnostics", diagnostic_msgs_msg_dds__DiagnosticArray__desc)) {
  node_.announce();
}

void StatePublisher::publish_needle(const RobotState& state, std::int64_t wall_ns) {
  const double depth_mm = state.measurement->depth_um * 1e-3;
  double depth_m = state.measurement->depth_um * 1e-6;
  char* joint = text(kJoint);
  sensor_msgs_msg_dds__JointState_ joints{};
  joints.header = header(wall_ns, "");
  joints.name = {1, 1, &joint, false};
  joints.position = {1, 1, &depth_m, false};
  node_.publish(joints_, &joints);
  const std_msgs_msg_dds__Float64_ depth{depth_m};
  node_.publish(depth_, &depth);
  if (!state.X_SR) return;
  const geometry_msgs_msg_dds__PoseStamped_ pose{header(wall_ns, kFrame), tip_pose(*state.X_SR, depth_mm)};
  node_.publish(pose_, &pose);
}

void StatePublisher::publish_mode(const Decision& decision) {
  const std::string mode(safety::name_of(decision.mode));
  const std_msgs_msg_dds__String_ message{text(mode)};
  node_.publish(mode_, &message);
}

void StatePublisher::publish_diagnostics(const RobotState& state, std::int64_t wall_ns) {
  const std::vector<Diagnostic> all = diagnostics_of(state);
  std::vector<std::vector<diagnostic_msgs_msg_dds__KeyValue_>> values;
  std::vector<diagnostic_msgs_msg_dds__DiagnosticStatus_> statuses;
  for (const Diagnostic& one : all) {
    auto& pairs = values.emplace_back();
    for (const auto& [key, value] : one.values) pairs.push_back({text(key), text(value)});
    const auto count = static_cast<std::uint32_t>(pairs.size());
    statuses.push_back({static_cast<std::uint8_t>(one.level),
                        text(one.name),
                        text(one.message),
                        text(hardware_),
                        {count, count, pairs.data(), false}});
  }
  const auto count = static_cast<std::uint32_t>(statuses.size());
  const diagnostic_msgs_msg_dds__DiagnosticArray_ message{header(wall_ns, ""),
                                                          {count, count, statuses.data(), false}};
  node_.publish(diagnostics_, &message);
}

void StatePublisher::publish(const RobotState& state, std::int64_t now_us, std::int64_t wall_ns) {
  if (state.measurement && state.measurement->seq != measured_seq_) {
    measured_seq_ = state.measurement->seq;
    if (state.measurement->laser_valid) publish_needle(state, wall_ns);
  }
  if (state.decision && is_due(mode_us_, now_us, kModeEvery_us)) publish_mode(*state.decision);
  if (is_due(diagnostics_us_, now_us, kDiagnosticsEvery_us)) publish_diagnostics(state, wall_ns);
}

}  // namespace biopsy::ros2
