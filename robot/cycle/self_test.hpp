// What the supervisor asks of itself at its start. A program file or a machine that decides wrongly must not
// get as far as deciding.
#pragma once

#include "planner/plan/seal.hpp"
#include "safety/challenge.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/supervisor.hpp"

namespace biopsy::robot {

// The functions that are examined: those that ship, unless a test puts in another.
struct Examined {
  decltype(&safety::assess) assess = safety::assess;
  decltype(&safety::step) step = safety::step;
  decltype(&safety::answer_to) answer_to = safety::answer_to;
  decltype(&planner::seal_holds) seal_holds = planner::seal_holds;
};

// Passed where each gives the known answers: what nobody looked at is a hazard, too much voltage is seen, a
// hazard ends motion, health lets the robot leave Boot, the challenge has its answer, a changed plan is
// noticed.
safety::SelfTest self_test(const Examined& examined = {});

}  // namespace biopsy::robot
