// The way back from a plan's canonical bytes (planner/plan/seal.hpp), for processes that receive a plan.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "robot/msg/plan.hpp"

namespace biopsy::planner {

// The plan, if the seal is that of these very bytes and every number in them is finite; nothing otherwise.
std::optional<Plan> open_plan(std::span<const std::uint8_t> bytes, const Sha256& seal);

}  // namespace biopsy::planner
