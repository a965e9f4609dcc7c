// A supervisor at rest with a sealed plan of two steps, and what its monitors are given.
#pragma once

#include <gtest/gtest.h>

#include "planner/plan/seal.hpp"
#include "robot/cycle/supervise.hpp"
#include "tests/robot/cycle/small_plan.hpp"

namespace biopsy::robot {

inline constexpr std::uint64_t kConfig = 77;
inline constexpr std::int64_t kNow_us = 10'000'000;

// Keeps what the monitors are given.
struct Capture final : FaultHooks {
  safety::SupervisorInputs inputs;
  void before_monitors(safety::SupervisorInputs& given) override { inputs = given; }
};

inline Plan two_steps() {
  return small_plan({2.0, 3.0}, {{Volts(0), Millimetres(-0.5), Millimetres(0.5)},
                                 {Volts(8000), Millimetres(2.0), Millimetres(6.0)}});
}

inline SealedPlan sealed(const Plan& plan) {
  const std::uint64_t tag = planner::plan_tag(plan);
  return {.seq = 1, .bytes = planner::canonical_bytes(plan), .seal = plan.seal, .confirmed_tag = {tag, tag}};
}

struct Supervise : testing::Test {
  Supervise() {
    memory.config_tag = kConfig;
    memory.self_test = safety::SelfTest::Passed;
    memory.state = safety::started(1);
    assume_tested_panel(memory);
    accept_plan(sealed(plan), memory);
    in.now_us = kNow_us;
    in.measurement.seq = 5;
    in.measurement.config_tag = in.request.config_tag = in.files_tag = kConfig;
    in.files_read_us = kNow_us;
    in.request.plan_tag = planner::plan_tag(plan), in.request.plan_seal = plan.seal;
    in.writers = 1;
    in.act.at_us = in.log.at_us = kNow_us;
  }
  const safety::SupervisorInputs& inputs() {
    supervise(in, memory, &seen);
    return seen.inputs;
  }

  const Plan plan = two_steps();
  SupervisorMemory memory;
  SupervisorSources in;
  Capture seen;
};

}  // namespace biopsy::robot
