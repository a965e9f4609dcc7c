// One run of a bench session, on a simulated or on a hardware stage.
#pragma once

#include <functional>
#include <string>

#include "drivers/hardware_needle_stage.hpp"
#include "drivers/pulse_output.hpp"
#include "robot/bench/bench_run.hpp"
#include "robot/bench/bench_session.hpp"

namespace biopsy::robot {

struct RunHooks {
  std::function<void(double)> show_progress;  // share of the run
  std::function<bool()> stop;
  std::function<void(const std::string&)> notify;  // what the operator must know at once
};

// On a new simulated stage: at rest, discharged.
BenchResult run_simulated(const BenchSession& session, std::size_t i, std::uint64_t seed,
                          const RunHooks& hooks);

// On the laboratory's stage, the same one for all runs: first at 0 V until the films are discharged; then the
// operator, instructed through `notify`, places the weight and turns the arm key.
BenchResult run_on_hardware(const BenchSession& session, std::size_t i, std::uint64_t config_tag,
                            drivers::HardwareNeedleStage& hardware, drivers::PulseOutput& supervisor_pulse,
                            const RunHooks& hooks);

}  // namespace biopsy::robot
