// Monitor and decide: from what arrived by bus, panel and clock to the permit of this tick. The one place
// where the supervisor's inputs are put together, live and in lockstep.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "drivers/digital_io/io_layout.hpp"
#include "robot/common/sha256.hpp"
#include "robot/cycle/fault_hooks.hpp"
#include "robot/cycle/stop_cause.hpp"
#include "robot/msg/messages.hpp"
#include "safety/monitors/panel_filter.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"

namespace biopsy::robot {

// The newest message of a topic and when it arrived, on the receiver's clock.
template <class Message>
struct Received {
  Message message{};
  std::int64_t at_us = 0;  // 0: none yet
};

// What reached the supervisor by the end of a tick.
struct SupervisorSources {
  std::int64_t now_us = 0;
  Measurement measurement;   // seq 0: none yet
  DriveRequest request;      // likewise
  std::int32_t writers = 0;  // writer_count() of the topics
  digital_io::PanelReading panel;
  std::uint64_t files_tag = 0;     // of the configuration's files as last read; 0: not known
  std::int64_t files_read_us = 0;  // when that reading began; 0: never
  Received<OperatorAct> act;
  Received<LogHealth> log;
  DepthVerdictNote verdict;
  Received<NavigationRequest> navigation;
};

// How many writers each topic has that must have one. Plans, verdicts and the log's health may have none:
// nothing is permitted for want of them.
struct WriterCounts {
  std::int32_t measurements = 0, requests = 0, acts = 0;
  std::int32_t measurements_alive = 0,
               requests_alive = 0;  // by liveliness: one that stands still counts as none
  std::int32_t plans = 0, verdicts = 0, log = 0;
};
// 1 where every topic is right, else a count that is not.
std::int32_t writer_count(const WriterCounts& counts);

// What the supervisor keeps from tick to tick.
struct SupervisorMemory {
  std::uint64_t config_tag = 0;  // of the configuration at start
  safety::SelfTest self_test = safety::SelfTest::Pending;
  safety::PlanFacts plan{};      // none: plan_tag 0
  std::uint64_t sealed_tag = 0;  // of the plan that was sent last, accepted or not; 0: seal broken
  std::array<std::uint64_t, 2> confirmed_tag{};  // that both confirmations were given for
  Sha256 seal{};                                 // of `plan`
  bool needs_second_person = false;  // a real stage: its plan is confirmed apart from the console as well
  struct SecondPerson {
    Sha256 seal{};           // that it was given for
    std::int64_t at_us = 0;  // 0: none
  } second_person{};
  safety::EvidenceMemory evidence{};
  safety::TissueMonitor tissue{};
  safety::PanelFilter panel{};
  safety::SupervisorState state{};
  Permit permit{};                                           // issued in the last tick
  std::int64_t act_us = 0;                                   // arrival of the last operator act that was used
  std::int64_t arm_turned_us = 0;                            // since when the arm key is turned; 0: it is not
  std::uint32_t verdict_session = 0, verdict_since_seq = 0;  // of the last verdict
  bool verdict_in_order = false;  // its image began under a permit that had been issued when it came
  bool patient_measured = false;  // by a sensor, at any time since the start
  StopCause stop_cause{};
};

// For rehearsals, which begin after a person tested the panel.
void assume_tested_panel(SupervisorMemory& memory);

struct Supervision {
  safety::Evidence evidence;
  safety::SupervisorOutput output;
  std::int32_t panel_unread_ms = 0;  // as in Decision
  std::uint64_t confirmed_tag = 0;   // likewise
};

// A plan is accepted while no high voltage is permitted. In motion it is only noticed: its tag is then not
// the sealed one any more, which stops the robot.
void accept_plan(const SealedPlan& sealed, SupervisorMemory& memory);

// Counts for three minutes or until the motion that began in them is over, and as long as the console
// confirms the plan too. Taken only of the plan that is sealed and that the console confirms now, and never
// while high voltage is permitted: what is not taken is forgotten.
void confirm_plan(const PlanConfirmation& confirmation, std::int64_t now_us, SupervisorMemory& memory);

Supervision supervise(const SupervisorSources& in, SupervisorMemory& memory, FaultHooks* faults = nullptr);

// What ended or prevents motion, for people: the hazard, or where there is none the event.
std::string cause_of(const safety::SupervisorOutput& output, std::int32_t panel_unread_ms);

// The message of a decision, and back.
Decision decision_message(const Supervision& supervision, std::int64_t now_us, std::int64_t wall_ns);
safety::SupervisorOutput supervisor_output(const Decision& decision, const Permit& permit);

}  // namespace biopsy::robot
