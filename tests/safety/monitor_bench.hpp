// Each monitor alone, sample by sample: everything is as it should be, and a test changes what it is about.
#pragma once

#include "safety/challenge.hpp"
#include "safety/monitors/depth_monitor.hpp"
#include "safety/monitors/link_monitor.hpp"
#include "safety/monitors/voltage_monitor.hpp"
#include "tests/safety/rig.hpp"

namespace biopsy::safety {

struct DepthBench {
  PlanFacts plan = three_step_plan();
  DepthMonitor monitor;
  SupervisorInputs seen;
  bool zero_volts = false;

  explicit DepthBench(Mode mode = Mode::Active) {
    seen.permit.mode = mode;
    seen.permit.depth_max_um = 1'000'000;
    seen.measurement.laser_valid = true;
  }
  HazardSet sample(std::int32_t depth_um) {
    seen.measurement.depth_um = depth_um;
    ++seen.measurement.laser_code;
    return update(plan, monitor, seen, LinkFindings{.fresh = true}, zero_volts).found;
  }
  HazardSet samples(int count, std::int32_t depth_um) {
    HazardSet found = 0;
    for (int i = 0; i < count; ++i) found = sample(depth_um);
    return found;
  }
  bool names(Hazard hazard) const { return (monitor.found & bit(hazard)) != 0; }
};

struct VoltageBench {
  PlanFacts plan = three_step_plan();
  VoltageMonitor monitor;
  SupervisorInputs seen;

  explicit VoltageBench(Mode mode = Mode::Active, bool enabled = true) {
    seen.permit.mode = mode;
    seen.permit.v_max_mV = 8'000'000;
    seen.permit.hv_enable = seen.measurement.hv_enabled = enabled;
    seen.acquiring = false;
  }
  DriveFindings sample(std::int32_t command_mV, std::int32_t monitor_mV, std::int32_t current_nA = 0) {
    seen.measurement.command_mV = command_mV;
    seen.measurement.monitor_mV = monitor_mV;
    seen.measurement.current_nA = current_nA;
    return update(plan, monitor, seen, true, false);
  }
  std::int32_t ceiling_mV(std::int32_t command_mV) { return sample(command_mV, command_mV).ceiling_mV; }
  bool names(Hazard hazard) const { return (monitor.found & bit(hazard)) != 0; }
};

struct LinkBench {
  PlanFacts plan = three_step_plan();
  LinkMonitor monitor;
  SupervisorInputs seen;
  HazardSet found = 0;

  LinkBench() {
    seen.now_us = 10'000'000;
    seen.measurement.time_us = 90'000'000;
    seen.measurement.verdict = GateVerdict::Granted;
    seen.measurement.command_mV = 1'000;
    seen.permit.session = 5, seen.permit.seq = 200, seen.permit.mode = Mode::Active;
    seen.writers = 1;
    seen.log_backlog_ms = seen.patient_motion_um = seen.tissue_residual_um = 0;
    seen.plan_tag = plan.plan_tag, seen.config_tag = plan.config_tag;
    seen.confirmed_tag = {plan.plan_tag, plan.plan_tag};
    monitor.plan_plausible = true;
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
    const LinkFindings findings = update(plan, monitor, seen);
    found = findings.found;
    return findings;
  }
  LinkFindings tick() { return advance(), observe(); }
  bool names(Hazard hazard) const { return (found & bit(hazard)) != 0; }
};

}  // namespace biopsy::safety
