// A person who sets a live robot in motion.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "robot/live/session/live_session.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::live_tests {

// Arms, presses, and goes on until the needle has moved for so many ticks and high voltage is on. What the
// person then does: presses. Nothing: it never came to that.
std::optional<robot::OperatorInputs> move(robot::LiveSession& session, const Plan& plan, std::int64_t ticks);

// A secured or plain robot that moves, in `folder`. Empty: it never did.
std::unique_ptr<robot::LiveSession> moving_robot(const robot::LiveOptions& options,
                                                 const robot::PreparedCase& prepared,
                                                 const std::filesystem::path& folder);

}  // namespace biopsy::live_tests
