#include "robot/transport/codec.hpp"

#include <algorithm>

namespace biopsy::transport {
namespace {

// The code, or what allows least where there is no such code.
template <class Enum>
Enum known(std::uint8_t code, Enum last, Enum least) {
  return code <= static_cast<std::uint8_t>(last) ? static_cast<Enum>(code) : least;
}

Mode mode_from(std::uint8_t code) {
  return known(code, Mode::Lock, Mode::Lock);
}
StopCategory stop_from(std::uint8_t code) {
  return known(code, StopCategory::C0Off, StopCategory::C0Off);
}

template <class Enum>
std::uint8_t code_of(Enum value) {
  return static_cast<std::uint8_t>(value);
}

// The fields that are the same on both sides, either way.
template <class From, class To>
void copy_measurement(const From& from, To& to) {
  to.seq = from.seq;
  to.time_us = from.time_us;
  to.depth_um = from.depth_um;
  to.laser_code = from.laser_code;
  to.laser_valid = from.laser_valid;
  to.monitor_mV = from.monitor_mV;
  to.current_nA = from.current_nA;
  to.command_mV = from.command_mV;
  to.hv_enabled = from.hv_enabled;
  to.answer = from.answer;
  to.answered_seq = from.answered_seq;
  to.config_tag = from.config_tag;
}

template <class From, class To>
void copy_drive_request(const From& from, To& to) {
  to.seq = from.seq;
  to.wanted_mV = from.wanted_mV;
  to.stage = from.stage;
  to.stage_reached = from.stage_reached;
  to.finished = from.finished;
  to.overruns = from.overruns;
  to.measured_seq = from.measured_seq;
  to.setpoint_um = from.setpoint_um;
  to.plan_tag = from.plan_tag;
  to.config_tag = from.config_tag;
}

template <class From, class To>
void copy_permit(const From& from, To& to) {
  to.session = from.session;
  to.epoch = from.epoch;
  to.seq = from.seq;
  to.issued_us = from.issued_us;
  to.ttl_us = from.ttl_us;
  to.hv_enable = from.hv_enable;
  to.v_max_mV = from.v_max_mV;
  to.slew_up_mV_per_tick = from.slew_up_mV_per_tick;
  to.slew_down_mV_per_tick = from.slew_down_mV_per_tick;
  to.depth_max_um = from.depth_max_um;
  to.plan_tag = from.plan_tag;
  to.config_tag = from.config_tag;
  to.challenge = from.challenge;
}

template <class From, class To>
void copy_decision(const From& from, To& to) {
  to.seq = from.seq;
  to.time_us = from.time_us;
  to.at_ns = from.at_ns;
  to.session = from.session;
  to.epoch = from.epoch;
  to.event = from.event;
  to.worst = from.worst;
  to.reason = from.reason;
  to.refusal = from.refusal;
  to.stage = from.stage;
  to.stage_done = from.stage_done;
  to.image_allowed = from.image_allowed;
  to.image_disturbed = from.image_disturbed;
}

template <class From, class To>
void copy_operator_act(const From& from, To& to) {
  to.seq = from.seq;
  to.token = from.token;
  to.held = from.held;
  to.finish = from.finish;
  to.acquiring = from.acquiring;
  to.arm = from.arm;
  to.reset = from.reset;
  to.patient_motion_um = from.patient_motion_um;
}

template <class From, class To>
void copy_depth_verdict_note(const From& from, To& to) {
  to.seq = from.seq;
  to.plan_tag = from.plan_tag;
  to.stage = from.stage;
  to.accepted = from.accepted;
}

template <class From, class To>
void copy_log_health(const From& from, To& to) {
  to.seq = from.seq;
  to.backlog_ms = from.backlog_ms;
  to.records = from.records;
}

template <class From, class To>
void copy_stage_truth(const From& from, To& to) {
  to.seq = from.seq;
  to.tip_nm = from.tip_nm;
  to.plate_b_nm = from.plate_b_nm;
  to.layers_entered = from.layers_entered;
}

template <class From, class To>
void copy_health(const From& from, To& to) {
  to.seq = from.seq;
  to.ready = from.ready;
  to.config_tag = from.config_tag;
  to.plan_tag = from.plan_tag;
  to.overruns = from.overruns;
  to.late_p50_us = from.late_p50_us;
  to.late_p99_us = from.late_p99_us;
  to.late_max_us = from.late_max_us;
  to.refused = from.refused;
}

}  // namespace

void encode(const Measurement& from, biopsy_wire_Measurement& to) {
  copy_measurement(from, to);
  to.verdict = code_of(from.verdict);
}

void decode(const biopsy_wire_Measurement& from, Measurement& to) {
  copy_measurement(from, to);
  to.verdict = known(from.verdict, GateVerdict::Limited, GateVerdict::Refused);
}

void encode(const DriveRequest& from, biopsy_wire_DriveRequest& to) {
  copy_drive_request(from, to);
}

void decode(const biopsy_wire_DriveRequest& from, DriveRequest& to) {
  copy_drive_request(from, to);
}

void encode(const Permit& from, biopsy_wire_Permit& to) {
  copy_permit(from, to);
  to.mode = code_of(from.mode);
  to.stop = code_of(from.stop);
}

void decode(const biopsy_wire_Permit& from, Permit& to) {
  copy_permit(from, to);
  to.mode = mode_from(from.mode);
  to.stop = stop_from(from.stop);
}

void encode(const Decision& from, biopsy_wire_Decision& to) {
  copy_decision(from, to);
  to.mode = code_of(from.mode);
  to.stop = code_of(from.stop);
}

void decode(const biopsy_wire_Decision& from, Decision& to) {
  copy_decision(from, to);
  to.mode = mode_from(from.mode);
  to.stop = stop_from(from.stop);
}

void encode(const OperatorAct& from, biopsy_wire_OperatorAct& to) {
  copy_operator_act(from, to);
  to.stop = code_of(from.stop);
}

void decode(const biopsy_wire_OperatorAct& from, OperatorAct& to) {
  copy_operator_act(from, to);
  to.stop = stop_from(from.stop);
}

void encode(const SealedPlan& from, biopsy_wire_SealedPlan& to) {
  to.seq = from.seq;
  const auto length = static_cast<std::uint32_t>(std::min(from.bytes.size(), kSealedPlanMax_bytes));
  to.bytes._maximum = to.bytes._length = length;
  to.bytes._buffer = const_cast<std::uint8_t*>(from.bytes.data());  // read only, the C type cannot say so
  to.bytes._release = false;
  std::copy(from.seal.begin(), from.seal.end(), to.seal);
  std::copy(from.confirmed_tag.begin(), from.confirmed_tag.end(), to.confirmed_tag);
}

void decode(const biopsy_wire_SealedPlan& from, SealedPlan& to) {
  to.seq = from.seq;
  to.bytes.assign(from.bytes._buffer, from.bytes._buffer + from.bytes._length);
  std::copy(std::begin(from.seal), std::end(from.seal), to.seal.begin());
  std::copy(std::begin(from.confirmed_tag), std::end(from.confirmed_tag), to.confirmed_tag.begin());
}

void encode(const DepthVerdictNote& from, biopsy_wire_DepthVerdict& to) {
  copy_depth_verdict_note(from, to);
}

void decode(const biopsy_wire_DepthVerdict& from, DepthVerdictNote& to) {
  copy_depth_verdict_note(from, to);
}

void encode(const LogHealth& from, biopsy_wire_LogHealth& to) {
  copy_log_health(from, to);
}

void decode(const biopsy_wire_LogHealth& from, LogHealth& to) {
  copy_log_health(from, to);
}

void encode(const StageTruth& from, biopsy_wire_StageTruth& to) {
  copy_stage_truth(from, to);
}

void decode(const biopsy_wire_StageTruth& from, StageTruth& to) {
  copy_stage_truth(from, to);
}

void encode(const Health& from, biopsy_wire_Health& to) {
  copy_health(from, to);
  to.process = code_of(from.process);
  const std::size_t length = std::min(from.note.size(), sizeof(to.note) - 1);
  std::copy_n(from.note.begin(), length, to.note);
  to.note[length] = '\0';
}

void decode(const biopsy_wire_Health& from, Health& to) {
  copy_health(from, to);
  to.process = known(from.process, Process::Person, Process::Person);
  const char* end = std::find(std::begin(from.note), std::end(from.note), '\0');
  to.note.assign(std::begin(from.note), end);
}

}  // namespace biopsy::transport
