// The watch over the links on a bench of its own, tick by tick.
#pragma once

#include "safety/challenge.hpp"
#include "safety/monitors/link_monitor.hpp"
#include "tests/safety/rig.hpp"

namespace biopsy::safety {

// Everything arrives in order and every answer is right; a test spoils what it is about.
struct LinkBench {
  PlanFacts plan = three_stage_plan();
  LinkMonitor watch;
  SupervisorInputs seen;
  HazardSet found = 0;

  LinkBench() {
    seen.now_us = 10'000'000;
    seen.measurement.time_us = 90'000'000;
    seen.measurement.verdict = GateVerdict::Granted;
    seen.measurement.command_mV = 1'000;
    seen.permit.session = 5, seen.permit.seq = 200, seen.permit.mode = Mode::Active;
    seen.writers = 1;
    seen.estop_a_closed = seen.estop_b_closed = true;
    seen.log_backlog_ms = seen.patient_motion_um = seen.tissue_residual_um = 0;
    seen.plan_tag = plan.plan_tag, seen.config_tag = plan.config_tag;
    seen.confirmed_tag = {plan.plan_tag, plan.plan_tag};
    watch.plan_plausible = true;
    for (int i = 0; i < 20; ++i) tick();
  }
  void advance() {
    seen.now_us += 1'000, seen.measurement.time_us += 1'000;
    ++seen.measurement.seq, ++seen.request.seq, ++seen.permit.seq;
    answer(seen.permit.seq);
  }
  void answer(std::uint32_t seq) {
    seen.measurement.answered_seq = seq;
    seen.measurement.answer =
        answer_to(challenge_of(5, seq), seen.measurement.command_mV, seen.permit.mode, seq);
  }
  LinkFindings observe() {
    const LinkFindings findings = update(plan, watch, seen);
    found = findings.found;
    return findings;
  }
  LinkFindings tick() { return advance(), observe(); }
  bool names(Hazard hazard) const { return (found & bit(hazard)) != 0; }
};

}  // namespace biopsy::safety
