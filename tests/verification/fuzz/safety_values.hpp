// Safety's plain values out of bytes, every field anything at all; and what must be true of every permit.
#pragma once

#include "safety/gate.hpp"
#include "safety/supervisor.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/situation.hpp"
#include "tests/verification/fuzz/target.hpp"

namespace biopsy::fuzz {

inline void fill(Feed& feed, Permit& p) {
  feed.fill(p.session, p.epoch, p.seq, p.issued_us, p.ttl_us, p.mode, p.stop, p.hv_enable, p.v_max_mV,
            p.slew_up_mV_per_tick, p.depth_max_um, p.plan_tag, p.config_tag, p.challenge);
}

inline void fill(Feed& feed, DriveRequest& r) {
  feed.fill(r.seq, r.wanted_mV, r.step, r.step_reached, r.finished, r.overruns, r.measured_seq,
            r.setpoint_um);
}

inline void fill(Feed& feed, Measurement& m) {
  feed.fill(m.seq, m.time_us, m.depth_um, m.laser_code, m.laser_valid, m.depth_b_um, m.laser_b_valid,
            m.monitor_mV, m.current_nA, m.command_mV, m.hv_enabled, m.answer, m.answered_seq, m.verdict);
}

inline void fill(Feed& feed, safety::GateState& s) {
  fill(feed, s.permit);
  feed.fill(s.permit_us, s.now_us, s.request_seq, s.drive_mV, s.enabled, s.started, s.latched);
}

inline void fill(Feed& feed, safety::SupervisorState& s) {
  feed.fill(s.mode, s.last_event, s.reason, s.step_done, s.arm_was_down, s.reset_was_down, s.session, s.epoch,
            s.seq, s.token, s.step, s.ms_in_mode, s.ms_since_held, s.held_mV);
}

inline void fill(Feed& feed, safety::Situation& i) {
  feed.fill(i.now_us, i.evidence.clear, i.evidence.zero_volts, i.evidence.needle_home,
            i.evidence.image_disturbed, i.evidence.drive_mV, i.evidence.ceiling_mV, i.self_test, i.local_arm,
            i.local_reset, i.remote_arm, i.remote_reset, i.stop, i.motion.token, i.motion.held,
            i.depth_accepted, i.accepted_step);
  fill(feed, i.request);
}

// Few bytes, so that many of them are reached: the head, then stages and bands as long as there are any.
inline void fill(Feed& feed, safety::PlanFacts& p) {
  feed.fill(p.plan_tag, p.config_tag, p.depth_max_um, p.tissue_residual_max_um, p.bench_half_period_ticks,
            p.step_count, p.band_count);
  for (std::size_t i = 0; i < 3; ++i) {
    feed.fill(p.steps[i].depth_max_um, p.steps[i].v_max_mV, p.steps[i].slew_up_mV_per_tick,
              p.steps[i].image_confirms);
    feed.fill(p.bands[i].drive_mV, p.bands[i].low_um, p.bands[i].high_um);
  }
}

inline void claim_sound(const Permit& permit) {
  claim(permit.v_max_mV >= 0 && permit.v_max_mV <= limits::kDriveMax_mV,
        "no permit beyond the robot's limit");
  claim(permit.hv_enable == safety::hv_permitted(permit.mode), "enabled in the hot modes and nowhere else");
  claim(permit.hv_enable || permit.v_max_mV == 0, "no voltage without the enable");
  claim(permit.slew_up_mV_per_tick == 0 || permit.mode == Mode::Active, "only Active may rise");
  claim(permit.slew_up_mV_per_tick >= 0 && permit.slew_up_mV_per_tick <= limits::kSlewUpMax_mV_per_tick,
        "no rise beyond the robot's limit");
}

}  // namespace biopsy::fuzz
