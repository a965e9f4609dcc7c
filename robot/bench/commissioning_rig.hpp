// Drives a stage for the steps of commissioning: 0.5 kV at most, each drive under a supervisor of its own and
// behind the gate.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "drivers/commissioning/rig.hpp"
#include "drivers/pulse_output.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/msg/plan.hpp"
#include "safety/types/plan_facts.hpp"

namespace biopsy::robot {

// What a stage has besides reading and writing. All optional.
struct StageConnections {
  struct Contacts {
    bool a_closed = false, b_closed = false;
  };
  std::function<Contacts()> estop;                   // as of the last read(); none: not wired to this device
  std::function<void(bool)> feed_interlock;          // none: nothing to feed
  drivers::PulseOutput* supervisor_pulse = nullptr;  // to the interlock; must outlive the rig
  bool real_time = false;  // 1 kHz on this computer's clock, else as fast as it goes
};

class SupervisedRig final : public commissioning::Rig {
 public:
  // `stage` must outlive this.
  SupervisedRig(drivers::NeedleStage& stage, StageConnections connections);

  commissioning::Sample rest() override;
  commissioning::Drive drive(std::int32_t level_mV, std::uint32_t ticks,
                             const std::function<bool(const commissioning::Sample&)>& go_on) override;
  void feed_interlock(bool feeding) override;
  void feed_supervisors_half(bool feeding) override { supervisor_feeds_ = feeding; }

 private:
  // Waits for the next tick, acts, and adds contacts and times to the sample.
  commissioning::Sample in_tick(const std::function<commissioning::Sample()>& act);

  drivers::NeedleStage& stage_;
  StageConnections connections_;
  Plan plan_;
  safety::PlanFacts facts_;
  std::optional<realtime::TickClock> clock_;
  std::int64_t ticked_ns_ = 0;
  bool supervisor_feeds_ = true;
};

}  // namespace biopsy::robot
