#include "safety/gate.hpp"

#include <algorithm>

#include "safety/challenge.hpp"
#include "safety/monitors/clock_step.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/magnitude.hpp"

namespace biopsy::safety {
namespace {

bool is_sound_clock(const GateState& state, std::int64_t now_us) {
  return !state.started || is_sound_step(state.now_us, now_us);
}

bool is_off(const GateState& state) {
  return state.drive_mV == 0 && !state.enabled;
}

bool is_live(const GateState& state, std::int64_t now_us) {
  const std::int32_t ttl_us = std::min(state.permit.ttl_us, limits::kPermitTtl_us);
  return state.permit.seq != 0 && is_less_than_after(state.permit_us, now_us, ttl_us);
}

// A new supervisor takes over only where nothing can move: output off, no permit of the old one alive, itself
// saying off.
bool may_bind(const GateState& state, const Permit& permit, std::int64_t now_us) {
  return permit.session > state.permit.session && is_off(state) && !permit.hv_enable &&
         !is_live(state, now_us);
}

bool is_fresh(const GateState& state, const Permit* permit) {
  return permit != nullptr && (permit->session != state.permit.session || permit->seq != state.permit.seq);
}

// Granted: to be honoured.
GateVerdict verdict_on(const GateState& state, const Permit& permit, std::int64_t now_us) {
  const bool bound = permit.session == state.permit.session && permit.session != 0;
  if (!bound && !may_bind(state, permit, now_us)) return GateVerdict::WrongSession;
  if (bound && permit.epoch < state.permit.epoch) return GateVerdict::OldEpoch;
  if (bound && permit.seq < state.permit.seq) return GateVerdict::OldSequence;
  return GateVerdict::Granted;
}

void switch_off(GateState& state) {
  state.drive_mV = 0;
  state.enabled = false;
  state.brake_on = false;
}

// Stops by itself: no permit is in force any more, until one disables HV.
GateVerdict stop_and_latch(GateState& state, GateVerdict why) {
  switch_off(state);
  state.permit.ttl_us = 0;
  state.latched = why;
  return why;
}

// A request counts once. A restarted controller numbers from 1 again and is accepted while the output is off.
bool take_request(GateState& state, const DriveRequest* request) {
  if (request == nullptr || request->seq == state.request_seq) return false;
  if (request->seq < state.request_seq && !is_off(state)) return false;
  state.request_seq = request->seq;
  return true;
}

// The one place where a voltage is decided.
GateVerdict drive(GateState& state, std::int32_t wanted_mV, bool may_rise) {
  const std::int64_t wanted = magnitude(wanted_mV);
  const std::int64_t present = magnitude(state.drive_mV);
  const std::int64_t envelope = std::clamp(state.permit.v_max_mV, 0, limits::kDriveMax_mV);
  const std::int64_t rise = std::clamp(state.permit.slew_up_mV_per_tick, 0, limits::kSlewUpMax_mV_per_tick);
  const std::int64_t given = std::min({wanted, envelope, may_rise ? present + rise : present});
  state.drive_mV = static_cast<std::int32_t>(wanted_mV < 0 ? -given : given);
  state.enabled = true;
  return given < wanted ? GateVerdict::Limited : GateVerdict::Granted;
}

// Takes up the permit if it is to be honoured; Granted also where none arrived.
GateVerdict accept_permit(GateState& state, const Permit* permit, std::int64_t now_us) {
  if (!is_fresh(state, permit)) return GateVerdict::Granted;
  const GateVerdict verdict = verdict_on(state, *permit, now_us);
  if (verdict != GateVerdict::Granted) return verdict;
  state.permit = *permit;
  state.permit_us = now_us;
  if (!permit->hv_enable) state.latched = GateVerdict::Granted;
  return verdict;
}

// What the permit in force makes of the request.
GateVerdict apply_command(GateState& state, const DriveRequest* request, std::int64_t now_us,
                          bool permit_is_good) {
  const bool new_request = take_request(state, request);
  const std::int32_t wanted_mV = new_request ? request->wanted_mV : state.drive_mV;
  if (state.permit.seq == 0) return switch_off(state), GateVerdict::NoPermit;
  if (state.latched != GateVerdict::Granted) return switch_off(state), state.latched;
  if (!is_live(state, now_us)) return stop_and_latch(state, GateVerdict::Expired);
  const bool off = !state.permit.hv_enable || state.permit.stop == StopCategory::C0Off;
  if (off) return switch_off(state), wanted_mV == 0 ? GateVerdict::Granted : GateVerdict::Limited;
  const bool may_increase = state.permit.mode == Mode::Active && state.permit.stop == StopCategory::None;
  const GateVerdict about_drive = drive(state, wanted_mV, may_increase && new_request && permit_is_good);
  // One lost request must not let a locked needle go.
  state.brake_on = state.permit.brake && (new_request ? request->brake : state.brake_on);
  return new_request ? about_drive : GateVerdict::NoRequest;
}

GateVerdict decide(GateState& state, const DriveRequest* request, const Permit* permit, std::int64_t now_us,
                   bool clock_is_sound, std::int32_t writer_count) {
  if (!clock_is_sound) return stop_and_latch(state, GateVerdict::ClockJump);
  if (writer_count != 1) return stop_and_latch(state, GateVerdict::SecondWriter);
  const GateVerdict about_permit = accept_permit(state, permit, now_us);
  const GateVerdict about_drive = apply_command(state, request, now_us, about_permit == GateVerdict::Granted);
  return about_permit == GateVerdict::Granted ? about_drive : about_permit;
}

}  // namespace

GateResult gate(const GateState& state, const DriveRequest* request, const Permit* permit,
                std::int64_t now_us, std::int32_t writer_count) {
  GateResult result{state};
  GateState& next = result.state;
  const bool sound = is_sound_clock(state, now_us);
  next.started = true;
  next.now_us = now_us;
  result.verdict = decide(next, request, permit, now_us, sound, writer_count);
  const bool feeds = next.permit.seq != 0 && next.permit.mode != Mode::Boot;
  result.voltage = GatedVoltage(next.drive_mV, next.enabled, next.brake_on, feeds);
  result.answered_seq = next.permit.seq;
  if (next.permit.seq != 0)
    result.answer = answer_to(next.permit.challenge, next.drive_mV, next.permit.mode, next.permit.seq);
  return result;
}

}  // namespace biopsy::safety
