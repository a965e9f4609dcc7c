// Self-test of the supervisor at its start: known inputs must give the known outputs. A corrupt program or a
// faulty processor must not decide.
#pragma once

#include "planner/plan/seal.hpp"
#include "safety/challenge.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/supervisor.hpp"

namespace biopsy::robot {

// The functions under test: those that ship, unless a unit test replaces one.
struct TestedFunctions {
  decltype(&safety::assess) assess = safety::assess;
  decltype(&safety::step) step = safety::step;
  decltype(&safety::answer_to) answer_to = safety::answer_to;
  decltype(&planner::seal_holds) seal_holds = planner::seal_holds;
};

// Passed if: unknown inputs are hazards, over-voltage is found, a hazard stops motion, health allows leaving
// Boot, the challenge has its answer, a changed plan breaks the seal.
safety::SelfTest self_test(const TestedFunctions& tested = {});

}  // namespace biopsy::robot
