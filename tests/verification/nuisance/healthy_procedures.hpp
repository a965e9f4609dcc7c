// A working day of healthy procedures, and whatever alarm there was without a reason.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "safety/types/supervisor_inputs.hpp"
#include "tests/verification/fault_injection/scenario.hpp"

namespace biopsy::fault_injection {

struct Alarm {
  std::size_t stage = 1;  // of those that were rehearsed
  std::uint64_t procedure = 0;
  double at_s = 0.0;
  std::string what;
};

struct HealthyRun {
  double hours = 0.0;
  std::int32_t procedures = 0, completed = 0, given_up = 0, steps = 0, releases = 0;
  std::int32_t trips = 0;             // into trip or lock
  std::int32_t unexpected_stops = 0;  // held, withdrawn or not ready for a hazard that was not there
  std::int32_t punctures_held = 0;    // held, the needle having truly jumped ahead when a layer gave way
  std::int32_t needles_held = 0;  // not ready, friction truly holding the needle more than 1 mm out at 0 V
  // Of the trips and unexpected stops, those whose hazard the plant truly had: a needle held out at 0 V, or
  // standing still under a rising voltage.
  std::int32_t borne_out = 0;
  std::vector<Alarm> alarms;  // the first of each procedure
};

// Of one run after another.
HealthyRun joined(HealthyRun a, const HealthyRun& b);

// Procedures of different scenarios and operators until `hours` are full. The same seed gives the same run.
// `corrupt_inputs`, if given, may corrupt what the supervisor sees: a bench that cannot complain proves
// nothing.
HealthyRun run_healthy_procedures(const NominalModels& models, double hours, std::uint64_t seed,
                                  const std::function<void(safety::SupervisorInputs&)>& corrupt_inputs,
                                  const std::function<void(double share)>& progress);

}  // namespace biopsy::fault_injection
