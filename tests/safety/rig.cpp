#include "tests/safety/rig.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace biopsy::safety {

Rig::Rig(std::uint32_t seed) : random_(seed) {
  memory.panel.test = PanelMonitor::Test::Passed;
}

void Rig::sense() {
  std::normal_distribution<double> noise(0.0, 1.0);
  const std::int64_t drive_mV = gate_state.drive_mV;
  depth_nm += (std::abs(drive_mV) / 2 - depth_nm) / 20;
  const auto depth_um = static_cast<std::int32_t>(depth_nm / 1'000) + push_um;
  ++measurement.seq;
  measurement.time_us = now_us;
  measurement.depth_um = depth_um + static_cast<std::int32_t>(std::lround(10.0 * noise(random_)));
  measurement.laser_code = measurement.depth_um;
  measurement.laser_valid = measurement.laser_b_valid = true;
  const double volts_noise = 0.002 * static_cast<double>(std::abs(drive_mV)) + 5'000.0;
  measurement.monitor_mV = static_cast<std::int32_t>(drive_mV + std::lround(volts_noise * noise(random_)));
  const std::int64_t change = drive_mV - measurement.command_mV;
  measurement.current_nA = static_cast<std::int32_t>(2 * change / 5);  // 2 nF, K = 0.8
  measurement.command_mV = gate_state.drive_mV;
  measurement.hv_enabled = gate_state.enabled;
  measurement.answer = gated.answer;
  measurement.answered_seq = gated.answered_seq;
  measurement.verdict = gated.verdict;
}

void Rig::supervise() {
  SupervisorInputs seen;
  seen.now_us = now_us;
  seen.measurement = measurement;
  on_measurement(seen.measurement);
  if (lasers_agree) seen.measurement.depth_b_um = seen.measurement.depth_um;
  seen.request = request;
  seen.permit = output.permit;
  seen.writers = writers;
  seen.panel_read = seen.estop_a_closed = seen.estop_b_closed = true;
  seen.local_reset = reset;
  const Mode mode = output.permit.mode;
  seen.relay_closed = seen.permit.seq != 0 && (mode == Mode::Ready || hv_permitted(mode));
  seen.acquiring = false;
  seen.log_backlog_ms = seen.patient_motion_um = seen.tissue_residual_um = 0;
  seen.plan_tag = plan.plan_tag;
  seen.config_tag = plan.config_tag;
  seen.confirmed_tag = {plan.plan_tag, plan.plan_tag};
  on_observation(seen);
  evidence = assess(plan, memory, seen);
  Situation input;
  input.now_us = now_us;
  input.evidence = evidence;
  input.self_test = SelfTest::Passed;
  input.local_arm = arm;
  input.local_reset = reset;
  input.stop = stop;
  input.motion = {held, held != 0};
  input.request = seen.request;
  input.depth_accepted = depth_accepted;
  input.accepted_step = state.step;
  input.accepted_session = state.session;
  input.accepted_since_seq = state.seq;
  on_input(input);
  std::tie(state, output) = step(plan, state, input);
}

void Rig::control() {
  ++wave_;
  const std::int32_t sign = (wave_ / flip_ticks) % 2 == 0 ? 1 : -1;
  ++request.seq;
  request.wanted_mV = hv_permitted(output.permit.mode) ? sign * wanted_mV : 0;
  request.step = output.step;
  request.step_reached = reached;
  request.finished = finished;
  on_request(request);
}

void Rig::tick() {
  sense();
  supervise();
  control();
  Permit permit = output.permit;
  const bool arrives = on_permit(permit);
  gated = gate(gate_state, &request, arrives ? &permit : nullptr, now_us, writers);
  gate_state = gated.state;
  now_us += 1'000;
}

void Rig::run(int ticks) {
  for (int i = 0; i < ticks; ++i) tick();
}

int Rig::ticks_until(const std::function<bool()>& is_there, int most) {
  for (int i = 1; i <= most; ++i) {
    tick();
    if (is_there()) return i;
  }
  return most + 1;
}

bool Rig::go_ready() {
  return ticks_until([this] { return state.mode == Mode::Ready; }, 100) <= 100;
}

bool Rig::go_armed() {
  if (!go_ready()) return false;
  arm = true;
  tick();
  arm = false;
  return state.mode == Mode::Armed;
}

bool Rig::go_active() {
  if (!go_armed()) return false;
  press();
  ticks_until([this] { return std::abs(gate_state.drive_mV) == wanted_mV; }, 8'000);
  run(900);  // settled, and the climb forgotten
  return state.mode == Mode::Active;
}

bool Rig::go_hold() {
  if (!go_active()) return false;
  release();
  on_input = [this](Situation& input) {
    if (held == 0) input.motion = {state.token, false};
  };
  tick();
  on_input = [](Situation&) {};
  return state.mode == Mode::Hold;
}

bool Rig::go_retract() {
  if (!go_active()) return false;
  stop = StopCategory::C1Ramp;
  tick();
  stop = StopCategory::None;
  return state.mode == Mode::Retract;
}

bool Rig::go_trip() {
  if (!go_active()) return false;
  stop = StopCategory::C0Off;
  tick();
  stop = StopCategory::None;
  release();
  return state.mode == Mode::Trip;
}

bool Rig::go_to(Mode mode) {
  constexpr bool (Rig::*kWays[])() = {nullptr,         nullptr,       &Rig::go_ready,   &Rig::go_armed,
                                      &Rig::go_active, &Rig::go_hold, &Rig::go_retract, &Rig::go_trip};
  if (mode == Mode::Safe) return ticks_until([this] { return state.mode == Mode::Safe; }, 100) <= 100;
  if (mode == Mode::Lock) {
    on_input = [](Situation& input) { input.self_test = SelfTest::Failed; };
    tick();
    on_input = [](Situation&) {};
  }
  if (mode == Mode::Boot || mode == Mode::Lock) return state.mode == mode;
  return (this->*kWays[static_cast<std::size_t>(mode)])();
}

}  // namespace biopsy::safety
