// One experiment on a stage, under the supervisor, from rest to rest.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "drivers/needle_stage.hpp"
#include "drivers/pulse_output.hpp"
#include "robot/bench/experiments.hpp"
#include "robot/msg/plan.hpp"
#include "sim/plant/dataset.hpp"

namespace biopsy::robot {

struct BenchResult {
  sim::RecordedRun recorded;
  std::string stopped_because;       // empty: the program was played to its end
  double stopped_s = 0.0;            // when it was stopped
  std::vector<std::string> remarks;  // what a reader of the rows has to know
};

// Keys of a real device, as of its last reading.
struct BenchKeys {
  bool arm = false, estop_closed = false;
};

struct Bench {
  drivers::NeedleStage& stage;           // at rest, and discharged once it has rested
  std::function<void(double)> push;      // N on plate A, from the next voltage on; stays at a stop
  std::function<void(double)> played;    // told now and then which share of the program
  std::function<BenchKeys()> keys = {};  // turned by hand; none: the script turns them
  drivers::PulseOutput* supervisor_pulse = nullptr;  // to the interlock; none: there is none
  Seconds rest{0.0};                       // at 0 V beforehand, until what an earlier run left is gone
  std::function<void()> ask_for_key = {};  // told when that is over and the key may be turned
  std::function<bool()> stop = {};         // somebody wants it to end: withdraws as at any stop
};

// Arms, holds the button while the program plays, then withdraws; gives up at whatever ends the motion before
// the program does. A real key counts from when it was asked for, and once it was seen open. Recorded to the
// last tick, with the voltage that the gate really put out: from the end of the rest, with a real key from
// when it was turned, and nobody's hand is at the stage any more. `plan`: made for this run by
// planner::plan_bench. `config_tag` is never 0.
BenchResult run_on_bench(const BenchRun& run, const Plan& plan, std::uint64_t config_tag, const Bench& bench);

}  // namespace biopsy::robot
