// What the loops hand to the functions of a cycle, kept as it came. The functions themselves, linked in place
// of those of robot/cycle and of the gate, decide nothing: they return what a test told them to.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "robot/cycle/actuate.hpp"
#include "robot/cycle/control.hpp"
#include "robot/cycle/supervise.hpp"

namespace biopsy::fake_cycle {

struct Drive {  // GatedStage::drive
  std::optional<DriveRequest> request;
  std::optional<Permit> permit;
  std::int64_t now_us = 0;
  std::int32_t writers = 0;
};

struct Calls {
  std::vector<robot::SupervisorSources> supervised;
  std::vector<SealedPlan> accepted;
  std::vector<std::pair<PlanConfirmation, std::int64_t>> confirmed;
  std::vector<robot::ControllerInputs> controlled;
  std::vector<SealedPlan> loaded;
  std::vector<Drive> driven;
  robot::WriterCounts writers;
  std::uint64_t supervisor_config = 0, controller_config = 0;
  safety::SelfTest self_test = safety::SelfTest::Pending;
  std::uint32_t session = 0;
  bool needs_second_person = false;

  // To be returned
  safety::SupervisorOutput output;
  std::int32_t panel_unread_ms = 0;
  std::int32_t writer_count = 1;
  std::uint64_t plan_tag = 0;  // of the plan that is sent; 0: its seal does not hold
  std::int64_t arm_turned_us = 0;
  bool feeds_interlock = true;
  std::int64_t control_ns = 0;                  // time that the controller takes for a request
  std::optional<safety::GatedVoltage> voltage;  // that the gate puts out; none: it writes nothing
};
Calls& calls();

// The two ways from a decision to a message and back: each a number of its own.
inline constexpr std::uint32_t kEpochOfMessage = 4'711;

}  // namespace biopsy::fake_cycle
