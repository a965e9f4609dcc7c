// Drives a stage for the steps of commissioning: small voltages, each under a supervisor of its own and
// behind the gate, as every other motion.
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

// What a stage has besides its port, and time. All optional.
struct StageTrimmings {
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
  SupervisedRig(drivers::NeedleStage& stage, StageTrimmings trimmings);

  commissioning::Sample rest() override;
  commissioning::Drive drive(std::int32_t level_mV, std::uint32_t ticks,
                             const std::function<bool(const commissioning::Sample&)>& go_on) override;
  void feed_interlock(bool feeding) override;
  void feed_supervisors_half(bool feeding) override { supervisor_feeds_ = feeding; }

 private:
  // Waits for the next tick, does it, and adds contacts and times to what it saw.
  commissioning::Sample in_tick(const std::function<commissioning::Sample()>& act);

  drivers::NeedleStage& stage_;
  StageTrimmings trimmings_;
  Plan plan_;
  safety::PlanFacts facts_;
  std::optional<realtime::TickClock> clock_;
  std::int64_t ticked_ns_ = 0;
  bool supervisor_feeds_ = true;
};

}  // namespace biopsy::robot
