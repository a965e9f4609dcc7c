// A plan as the supervisor uses it: integers.
#pragma once

#include <cstdint>

#include "robot/msg/plan.hpp"
#include "safety/types/plan_facts.hpp"

namespace biopsy::robot {

// `config_tag`: identifies the configuration in use; never 0. Throws ConfigError for a plan with more steps
// than the supervisor can hold.
safety::PlanFacts plan_facts(const Plan& plan, std::uint64_t config_tag);

}  // namespace biopsy::robot
