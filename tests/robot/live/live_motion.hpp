// A person who sets a live robot in motion.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "robot/live/session/live_session.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::live_tests {

struct Motion {
  std::optional<robot::OperatorInputs> pressing;  // what the operator then does; empty: it never moved
  std::string prevented_by;                       // the hazard that it never moved for, if there was one
};

// Arms, presses, and goes on until the needle has moved for so many ticks and high voltage is on.
Motion move(robot::LiveSession& session, const Plan& plan, std::int64_t ticks);

struct MovingRobot {
  std::unique_ptr<robot::LiveSession> session;  // empty: it never moved
  std::string prevented_by;
};

// A secured or plain robot that moves, in `folder`.
MovingRobot moving_robot(const robot::LiveOptions& options, const robot::PreparedCase& prepared,
                         const std::filesystem::path& folder);

}  // namespace biopsy::live_tests
