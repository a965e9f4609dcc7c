// What became of each fault of a run: when it began, and which hazard named it first.
#pragma once

#include <cstdint>
#include <vector>

#include "robot/cycle/run_cycle.hpp"
#include "robot/report/procedure/run_record.hpp"
#include "sim/faults/fault.hpp"

namespace biopsy::robot {

class FaultNotes {
 public:
  explicit FaultNotes(const std::vector<sim::Fault>& faults);

  // Every tick of the robot, in order. `active`: bit i, fault i was in force.
  void add(const CycleRecord& tick, std::uint32_t active);

  // With the depth checks of `record` that did not accept while a fault was there and unnamed.
  void finish(report::RunRecord& record) const;

 private:
  std::vector<report::FaultResult> results_;
  std::vector<safety::HazardSet> before_;  // present when the fault began, so not caused by it
  safety::HazardSet last_ = 0;
  std::int64_t ticks_ = 0;
};

}  // namespace biopsy::robot
