// A small lockstep loop for the tests: supervisor and gate as shipped around the simplest stage that behaves,
// with one place to corrupt every message. Depth follows |V| (0.5 mm/kV, first order in 20 ms) with 10 um of
// laser noise; the monitor shows the command with 0.2 % noise; the controller climbs with the permit's slew
// and changes polarity at 2 Hz.
#pragma once

#include <functional>
#include <random>
#include <tuple>

#include "safety/gate.hpp"
#include "safety/monitors/evidence.hpp"
#include "safety/supervisor.hpp"
#include "tests/safety/plan.hpp"
#include "tests/safety/situation.hpp"

namespace biopsy::safety {

class Rig {
 public:
  explicit Rig(std::uint32_t seed = 1);

  // Spoilers, called in every tick with what would have been seen.
  std::function<void(Measurement&)> on_measurement = [](Measurement&) {};
  std::function<void(SupervisorInputs&)> on_observation = [](SupervisorInputs&) {};
  std::function<void(Situation&)> on_input = [](Situation&) {};
  std::function<void(DriveRequest&)> on_request = [](DriveRequest&) {};
  std::function<bool(Permit&)> on_permit = [](Permit&) { return true; };  // false: lost on the way

  void tick();
  void run(int ticks);
  int ticks_until(const std::function<bool()>& reached, int most);  // most + 1 where it never was

  // Healthy scripts.
  bool go_ready();
  bool go_armed();
  bool go_active();
  bool go_hold();
  bool go_retract();
  bool go_trip();
  bool go_to(Mode mode);
  void press() { held = ++token_; }
  void release() { held = 0; }

  PlanFacts plan = three_step_plan();
  EvidenceMemory memory;
  SupervisorState state = started(7);
  SupervisorOutput output;
  Evidence evidence;
  GateState gate_state;
  GateResult gated;
  Measurement measurement;
  DriveRequest request;

  std::int64_t now_us = 1'000'000;
  std::uint32_t held = 0;  // token of the button being held, 0 = none
  bool arm = false, reset = false, reached = false, finished = false;
  bool depth_accepted = false;
  std::int32_t wanted_mV = 6'000'000;
  std::int32_t flip_ticks = 250;  // half a period
  std::int64_t depth_nm = 0;
  std::int32_t writers = 1;
  std::int32_t push_um = 0;  // added to the true depth
  bool lasers_agree = true;  // the second shows what the first does, also where a test corrupts it
  StopCategory stop = StopCategory::None;

 private:
  void sense();
  void supervise();
  void control();
  std::mt19937 random_;
  std::uint32_t token_ = 0;
  std::int64_t wave_ = 0;
};

}  // namespace biopsy::safety
