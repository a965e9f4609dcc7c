// An operator drawn at random: slow or quick, releases and presses again, waits on hold, takes images,
// sometimes gives up half-way.
#pragma once

#include <cstdint>

#include "robot/cycle/run_cycle.hpp"
#include "tests/verification/fault_injection/draw.hpp"

namespace biopsy::fault_injection {

class VariedOperator {
 public:
  VariedOperator(const Plan& plan, std::uint64_t seed);

  robot::OperatorInputs act(const robot::CycleRecord& seen);

  bool done() const { return step_ == Step::Done; }
  bool completed() const { return completed_; }
  bool gave_up() const { return gives_up_ && !completed_; }
  std::int32_t releases() const { return releases_; }

 private:
  enum class Step : std::uint8_t { Wait, Arm, Think, Insert, Lock, Image, Withdraw, Done };

  void go(Step step, std::int32_t ticks);
  void watch(const robot::CycleRecord& seen);
  void insert(const robot::CycleRecord& seen);
  void reach(const robot::CycleRecord& seen);

  const Plan& plan_;
  Draw draw_;
  Step step_ = Step::Wait;
  std::int32_t left_;  // ticks until the next act
  std::int32_t quits_in_;
  bool gives_up_, by_stop_;
  std::uint32_t token_ = 0, accepted_step_ = 0;
  Permit imaged_under_;  // in force when the last image began to be taken
  bool imaging_ = false;
  bool held_ = false, accepted_ = false, completed_ = false;
  std::int32_t releases_ = 0, held_back_ = 0;
};

}  // namespace biopsy::fault_injection
