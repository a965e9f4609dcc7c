// What the processes of the live robot tell each other beside Measurement, DriveRequest and Permit.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "robot/msg/permit.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy {

enum class Process : std::uint8_t { Interlock, Recorder, Supervisor, Stage, Controller, Person };
inline constexpr std::size_t kProcesses = 6;

constexpr const char* name_of(Process process) {
  constexpr std::array<const char*, kProcesses> kNames{"interlock", "recorder",   "supervisor",
                                                       "stage",     "controller", "person"};
  return kNames[static_cast<std::size_t>(process)];
}

// What the supervisor decided in a tick, for people, controller and log. The codes of event, hazards and
// refusal are the enumerations of safety/, whose names only it knows.
struct Decision {
  std::uint32_t seq = 0;     // that of the permit of the same tick
  std::int64_t time_us = 0;  // supervisor's clock
  std::int64_t at_ns = 0;    // wall clock, UTC since 1970: for the log, decides nothing
  std::uint32_t session = 0, epoch = 0;
  Mode mode = Mode::Boot;
  StopCategory stop = StopCategory::C0Off;
  std::uint8_t event = 0, worst = 0, reason = 0, refusal = 0;
  std::uint32_t stage = 0;     // the controller is to drive
  bool stage_done = false;     // waits for the depth check and a new press
  bool image_allowed = false;  // a scan may start
  bool image_disturbed = true;
};

// What the person at the console or in a rehearsal asks for, sent at least every 50 ms. No message can arm or
// reset: the two flags exist so that the asking is refused and logged.
struct OperatorAct {
  std::uint32_t seq = 0;
  std::uint32_t token = 0;  // of the present press; see safety::MotionPress
  bool held = false;
  StopCategory stop = StopCategory::None;
  bool finish = false;    // withdraw, the procedure is over
  bool acquiring = true;  // the scanner is taking an image
  bool arm = false, reset = false;
  std::int32_t patient_motion_um = 0;

  bool operator==(const OperatorAct&) const = default;
};
constexpr bool asks_the_same(OperatorAct a, const OperatorAct& b) {
  a.seq = b.seq;
  return a == b;
}

// The plan as it was sealed (planner/plan/seal.hpp), and the tags that two confirmations were given for.
struct SealedPlan {
  std::uint32_t seq = 0;
  std::vector<std::uint8_t> bytes;  // canonical, at most kSealedPlanMax_bytes
  Sha256 seal{};
  std::array<std::uint64_t, 2> confirmed_tag{};
};
inline constexpr std::size_t kSealedPlanMax_bytes = 60'000;

// The answer of a depth check on a new image, or of the person where none is wanted.
struct DepthVerdictNote {
  std::uint32_t seq = 0;
  std::uint64_t plan_tag = 0;
  std::uint32_t stage = 0;
  bool accepted = false;
};

struct LogHealth {
  std::uint32_t seq = 0;
  std::int32_t backlog_ms = 0;  // age of the oldest record that is not on disk
  std::uint64_t records = 0;    // written so far
};

// The simulated stage's truth; a real stage publishes none. Of the same tick as the measurement `seq`.
struct StageTruth {
  std::uint32_t seq = 0;
  std::int32_t tip_nm = 0, plate_b_nm = 0;
  std::uint8_t layers_entered = 0;  // surfaces that gave way
};

// A process is alive, with what configuration and plan, and how it keeps time.
struct Health {
  Process process = Process::Person;
  std::uint32_t seq = 0;
  bool ready = false;
  std::uint64_t config_tag = 0, plan_tag = 0;                      // of what it really uses; 0: none
  std::uint32_t overruns = 0;                                      // periods missed since start
  std::int32_t late_p50_us = 0, late_p99_us = 0, late_max_us = 0;  // of its ticks
  std::uint32_t refused = 0;  // messages from strangers, that were not let in
  std::string note;           // for a person, at most 120 characters
};

}  // namespace biopsy
