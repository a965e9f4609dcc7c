// A whole procedure against a simulated stage and scanner, from a sealed plan to a run record.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "robot/cycle/run_cycle.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"
#include "sim/faults/fault.hpp"

namespace biopsy::robot {

// Called now and then with the share that is done, in [0, 1], and what is going on.
using Progress = std::function<void(double share, const std::string& what)>;

// True position of needle and plate; known in simulation only.
struct Truth {
  double tip_mm = 0.0, plate_b_mm = 0.0;
  int layers_entered = 0;           // whose surface gave way
  std::uint32_t active_faults = 0;  // sim::FaultyStage
};

// One tick of a robot; the truth is that at its beginning.
struct CycleSample {
  CycleRecord record;
  Truth truth;
  Millimetres setpoint;
  bool newest = true;  // no later tick is waiting to be read: live, this is what an operator sees
};

// Applies the inputs and returns the next tick, in order. Nothing: the robot is silent.
using Robot = std::function<std::optional<CycleSample>(const OperatorInputs&)>;

// The record of a plan (or its refusal) before anything moved.
report::RunRecord planned_record(const PreparedCase& prepared);

// Ends early, with what was recorded, where `stop` is requested. Confirmation images are written to
// `folder`/images as DICOM and read back. `prepared` must hold a plan.
report::RunRecord rehearse_on(const Robot& robot, const PreparedCase& prepared,
                              const std::filesystem::path& folder, const Progress& progress,
                              const std::stop_token& stop = {});

// The same in lockstep on a virtual clock: the same inputs give the same run, to the bit. `faults` are put
// between the plant and the robot.
report::RunRecord rehearse(const PreparedCase& prepared, const std::filesystem::path& folder,
                           const Progress& progress, const std::stop_token& stop = {},
                           const std::vector<sim::Fault>& faults = {});

}  // namespace biopsy::robot
