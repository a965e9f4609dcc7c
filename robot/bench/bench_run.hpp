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
  std::vector<std::string> remarks;  // on the rows
};

// Keys of a real device, as of its last reading.
struct BenchKeys {
  bool arm = false, estop_closed = false;
};

struct Bench {
  drivers::NeedleStage& stage;                // at rest, and discharged once it has rested
  std::function<void(double)> push;           // N on plate A, from the next voltage on; stays at a stop
  std::function<void(double)> show_progress;  // which share of the program was played
  std::function<BenchKeys()> keys = {};       // turned by hand; none: the script turns them
  drivers::PulseOutput* supervisor_pulse = nullptr;  // to the interlock; none: there is none
  Seconds rest{0.0};                       // at 0 V beforehand, until the effect of an earlier run is gone
  std::function<void()> request_key = {};  // once that is over and the key may be turned
  std::function<bool()> stop = {};         // true: withdraws as at any stop
};

// Plays the run's program as BenchOperator arms, holds and withdraws; gives up at whatever ends the motion
// before the program does. Recorded to the last tick, with the voltage that the gate really put out: from the
// end of the rest or, with a real key, from when it was turned and all hands are off the stage. `plan`: made
// for this run by planner::plan_bench. `config_tag` is never 0.
BenchResult run_on_bench(const BenchRun& run, const Plan& plan, std::uint64_t config_tag, const Bench& bench);

}  // namespace biopsy::robot
