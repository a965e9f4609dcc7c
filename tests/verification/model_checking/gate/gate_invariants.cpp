#include "tests/verification/model_checking/gate/gate_invariants.hpp"

#include <algorithm>

namespace biopsy::model_checking {

bool GateStep::is_live() const {
  const std::int64_t life_us = std::min(after.permit.ttl_us, 5'000);
  return after.permit.seq != 0 && now_us - after.permit_us < life_us && now_us >= after.permit_us;
}

bool GateStep::was_honoured() const {
  const Permit &old = before.permit, &now = after.permit;
  return old.session != now.session || old.seq != now.seq || old.epoch != now.epoch;
}

const std::array<GateInvariant, kGateInvariants> kGateInvariantTable{{
    {"gate-rise-needs-a-live-permit",
     "The voltage rises only under a live, enabled permit of Active without a stop.",
     [](const GateStep& s) {
       const Permit& p = s.after.permit;
       return Finding{s.rises(),
                      s.is_live() && p.hv_enable && p.mode == Mode::Active && p.stop == StopCategory::None};
     }},
    {"gate-rise-needs-a-request", "The voltage rises only on a new request, and not beyond it.",
     [](const GateStep& s) {
       const std::int64_t wanted = s.input.request ? s.input.request->wanted_mV : 0;
       return Finding{s.rises(), s.is_request_new() && s.is() <= (wanted < 0 ? -wanted : wanted)};
     }},
    {"gate-rise-needs-order",
     "Nothing rises on an unsound clock, beside a second writer, or in the tick of a refused permit.",
     [](const GateStep& s) {
       const bool refused = s.verdict == GateVerdict::WrongSession || s.verdict == GateVerdict::OldEpoch ||
                            s.verdict == GateVerdict::OldSequence;
       return Finding{s.rises(), s.is_clock_sound() && s.input.writers == 1 && !refused};
     }},
    {"gate-steepness", "A rise is no steeper than the permit allows, and never above 400 V a tick.",
     [](const GateStep& s) {
       return Finding{s.rises(), s.is() - s.was() <= std::min(s.after.permit.slew_up_mV_per_tick, 400'000)};
     }},
    {"gate-limits", "The voltage is never beyond the permit's envelope, nor beyond 8 kV.",
     [](const GateStep& s) {
       return Finding{s.mV != 0, s.is() <= std::clamp(s.after.permit.v_max_mV, 0, 8'000'000)};
     }},
    {"gate-lowering-passes", "A new request for less is followed in that tick, whatever the permit.",
     [](const GateStep& s) {
       const std::int64_t wanted = s.input.request ? s.input.request->wanted_mV : 0;
       const std::int64_t least = wanted < 0 ? -wanted : wanted;
       const bool newer = s.input.request && s.input.request->seq > s.before.request_seq;
       return Finding{newer && least < s.was(), s.is() <= least};
     }},
    {"gate-silent-request", "Without a new request the voltage neither rises nor changes sign.",
     [](const GateStep& s) {
       return Finding{!s.is_request_new(),
                      !s.rises() && (s.mV == 0 || (s.mV < 0) == (s.before.drive_mV < 0))};
     }},
    {"gate-no-permit-no-voltage", "Without a live permit the output is off in that tick.",
     [](const GateStep& s) {
       return Finding{!s.is_live(), s.is_off()};
     }},
    {"gate-off-is-off", "A permit for off or C0 switches off in that tick.",
     [](const GateStep& s) {
       return Finding{!s.after.permit.hv_enable || s.after.permit.stop == StopCategory::C0Off, s.is_off()};
     }},
    {"gate-clock-and-writers", "A clock that jumps or not exactly one writer switches off, and latches.",
     [](const GateStep& s) {
       return Finding{!s.is_clock_sound() || s.input.writers != 1,
                      s.is_off() && s.after.latched != GateVerdict::Granted};
     }},
    {"gate-latches", "A latched output is off; the latch ends only with an honoured permit for off.",
     [](const GateStep& s) {
       const bool latched = s.after.latched != GateVerdict::Granted;
       return Finding{latched || s.before.latched != GateVerdict::Granted,
                      latched ? s.is_off() : s.was_honoured() && !s.after.permit.hv_enable};
     }},
    {"gate-expiry-latches", "Voltage that ends because the permit ended stays away.",
     [](const GateStep& s) {
       return Finding{s.before.enabled && !s.is_live(), s.after.latched != GateVerdict::Granted};
     }},
    {"gate-order-of-permits", "Within a session number and epoch of the honoured permit never go back.",
     [](const GateStep& s) {
       const Permit &old = s.before.permit, &now = s.after.permit;
       return Finding{s.was_honoured() && old.session == now.session,
                      now.seq > old.seq && now.epoch >= old.epoch};
     }},
    {"gate-new-session",
     "A session is taken up only by a later one, with the output off, by a permit for off, and no permit "
     "alive.",
     [](const GateStep& s) {
       const Permit &old = s.before.permit, &now = s.after.permit;
       const bool alive = old.seq != 0 && s.now_us - s.before.permit_us < std::min(old.ttl_us, 5'000);
       return Finding{old.session != now.session, now.session > old.session && !now.hv_enable && !alive &&
                                                      s.before.drive_mV == 0 && !s.before.enabled};
     }},
    {"gate-brake-needs-a-live-permit",
     "The brake is on only under a live permit that enables the drive and the brake.",
     [](const GateStep& s) {
       return Finding{s.brake_on, s.is_live() && s.after.permit.hv_enable && s.after.permit.brake};
     }},
    {"gate-brake-follows-the-request",
     "Where the brake may be on it is what the newest request asks for, and otherwise off.",
     [](const GateStep& s) {
       const bool may = s.is_live() && s.hv_enabled && s.after.permit.brake;
       const bool taken = s.is_request_new() && s.after.request_seq == s.input.request->seq;
       const bool wanted = taken ? s.input.request->brake : s.before.brake_on;
       return Finding{true, s.brake_on == (may && wanted)};
     }},
    {"gate-life", "A permit's life begins once: the same one again does not lengthen it.",
     [](const GateStep& s) {
       return Finding{!s.was_honoured() && s.before.permit.seq != 0, s.after.permit_us == s.before.permit_us};
     }},
}};

}  // namespace biopsy::model_checking
