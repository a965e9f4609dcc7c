#include "robot/live/bus_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/cycle/stop_cause.hpp"
#include "safety/supervisor.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/thresholds.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::robot {
namespace {

using LogBody = nlohmann::json;
using recorder::RecordKind;
using recorder::Urgency;

constexpr std::int64_t kReportEvery_us = 50'000;
constexpr std::int64_t kNever_ms = INT32_MAX;
constexpr std::int64_t kLivelyEvery_us = 200'000;
constexpr std::int64_t kRefusalsApart_us = 1'000'000;
constexpr std::int64_t kAuthentication_us = 1'500'000;  // authentication takes about a second

std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

// Invalid UTF-8 in a message must not end the recorder.
std::string json_text(const LogBody& body) {
  return body.dump(-1, ' ', false, LogBody::error_handler_t::replace);
}

std::string hazard(std::uint8_t code, const Decision& decision) {
  return robot::hazard_text(static_cast<safety::Hazard>(code), decision.panel_unread_ms);
}

std::string event(std::uint8_t code) {
  return code < safety::kEvents ? std::string(safety::name_of(static_cast<safety::Event>(code))) : "unknown";
}

std::string refusal(std::uint8_t code) {
  return std::string(safety::name_of(static_cast<safety::Refusal>(code)));
}

LogBody json_of(const Decision& decision) {
  return {{"mode", safety::name_of(decision.mode)},
          {"event", event(decision.event)},
          {"reason", hazard(decision.reason, decision)},
          {"worst", hazard(decision.worst, decision)},
          {"stop", static_cast<int>(decision.stop)},
          {"stage", decision.step + 1},
          {"stage_done", decision.step_done},
          {"session", decision.session},
          {"epoch", decision.epoch},
          {"seq", decision.seq}};
}

// Limiting, and a tick without a new request, are normal operation of the gate.
bool refuses(GateVerdict verdict) {
  return verdict != GateVerdict::Granted && verdict != GateVerdict::Limited &&
         verdict != GateVerdict::NoRequest;
}

}  // namespace

BusRecorder::BusRecorder(const transport::Participant& bus, recorder::Recorder& recorder,
                         std::uint64_t config_tag, const transport::ParticipantMonitor* participants)
    : recorder_(recorder),
      participants_(participants),
      decisions_(bus),
      acts_(bus),
      plans_(bus),
      confirmations_(bus),
      verdicts_(bus),
      sensors_(bus),
      measurements_(bus),
      requests_(bus),
      log_health_(bus),
      heartbeat_(bus, Process::Recorder, config_tag),
      board_(bus) {
  heartbeat_.health().ready = true;
  decision_.worst =
      static_cast<std::uint8_t>(safety::Hazard::None);  // before the first decision: code 0 is a hazard
}

void BusRecorder::write(RecordKind kind, std::string_view source, std::string body, Urgency urgency,
                        std::int64_t now_us) {
  recorder_.append({wall_ns(), now_us, std::string(source), kind, std::move(body)}, urgency, now_us);
}

void BusRecorder::note(RecordKind kind, const std::string& body, std::int64_t now_us) {
  write(kind, "recorder", body, Urgency::Urgent, now_us);
}

// Each with the supervisor's own times.
void BusRecorder::follow_decisions(std::int64_t now_us) {
  Decision next;
  const auto note = [&](RecordKind kind, const LogBody& body, Urgency urgency) {
    recorder_.append({next.at_ns, next.time_us, "supervisor", kind, json_text(body)}, urgency, now_us);
  };
  while (decisions_.take(next)) {
    const bool new_session = next.session != decision_.session;
    if (!new_session && decision_.seq != 0 && next.seq != decision_.seq + 1)
      note(RecordKind::ReceptionGap, {{"from_seq", decision_.seq + 1}, {"to_seq", next.seq - 1}},
           Urgency::Grouped);
    if (new_session || next.mode != decision_.mode)
      note(RecordKind::StateChange, json_of(next), Urgency::Urgent);
    else if (next.stop != decision_.stop || next.step != decision_.step ||
             next.step_done != decision_.step_done)
      note(RecordKind::PermitChange, json_of(next), Urgency::Grouped);
    // A panel that was unread tells for how long once it is read again.
    const bool told = next.worst == static_cast<std::uint8_t>(safety::Hazard::EStop) &&
                      next.panel_unread_ms != decision_.panel_unread_ms;
    if (next.worst != decision_.worst || told)
      note(RecordKind::Alarm,
           {{"worst", hazard(next.worst, next)},
            {"before", hazard(decision_.worst, decision_)},
            {"seq", next.seq}},
           Urgency::Grouped);
    // Beside a hazard that is worse it shows in nothing else.
    const std::uint8_t stop = static_cast<std::uint8_t>(safety::Hazard::EStop);
    const bool hidden = next.worst != stop && decision_.worst != stop && decision_.seq != 0;
    if (hidden && next.estop != decision_.estop)
      note(RecordKind::Alarm, {{"beside", hazard(stop, next)}, {"over", !next.estop}, {"seq", next.seq}},
           Urgency::Grouped);
    if (next.refusal != 0) {
      // A button that stays down asks with every message: one record, until it was quiet for a while.
      if (next.session != last_refused_.session || next.refusal != last_refused_.refusal ||
          next.time_us - last_refused_.time_us >= kRefusalsApart_us)
        note(RecordKind::RequestRefused, {{"why", refusal(next.refusal)}, {"seq", next.seq}},
             Urgency::Grouped);
      last_refused_ = next;
    }
    decision_ = next;
    decision_us_ = now_us;
  }
}

void BusRecorder::follow_acts(std::int64_t now_us) {
  OperatorAct next;
  while (acts_.take(next)) {
    act_.seq = next.seq;
    if (next != act_)
      write(RecordKind::OperatorAct, "person",
            json_text({{"operator", operator_name_},
                       {"token", next.token},
                       {"held", next.held},
                       {"stop", static_cast<int>(next.stop)},
                       {"finish", next.finish},
                       {"acquiring", next.acquiring},
                       {"hold_still", next.hold_still},
                       {"asks_arm", next.arm},
                       {"asks_reset", next.reset},
                       {"patient_motion_mm", next.patient_motion_um * 1e-3}}),
            Urgency::Grouped, now_us);
    act_ = next;
  }
}

void BusRecorder::follow_plan_and_checks(std::int64_t now_us) {
  SealedPlan sealed;
  while (plans_.take(sealed)) {
    const std::optional<Plan> plan = planner::open_plan(sealed.bytes, sealed.seal);
    LogBody body{{"seal", hex(sealed.seal)}, {"seal_holds", plan.has_value()}};
    if (plan) {
      body["patient"] = plan->target.patient_id;
      body["series_uid"] = plan->target.series_uid;
      body["target_mm"] = plan->target_depth.value;
      body["stages"] = plan->steps.size();
      body["confirmations"] = (sealed.confirmed_tag[0] == planner::plan_tag(*plan)) +
                              (sealed.confirmed_tag[1] == planner::plan_tag(*plan));
    }
    body["operator"] = operator_name_;
    write(RecordKind::Plan, "person", json_text(body), Urgency::Urgent, now_us);
  }
  PlanConfirmation confirmation;
  while (confirmations_.take(confirmation))
    write(RecordKind::PlanConfirmation, "confirmer",
          json_text({{"operator", confirmation.person}, {"seal", hex(confirmation.seal)}}), Urgency::Urgent,
          now_us);
  DepthVerdictNote verdict;
  while (verdicts_.take(verdict))
    write(RecordKind::DepthCheck, "person",
          json_text({{"operator", operator_name_},
                     {"stage", verdict.step + 1},
                     {"accepted", verdict.accepted},
                     {"since_seq", verdict.since_seq}}),
          Urgency::Urgent, now_us);
}

// A sensor of the patient's motion: that it begins and ends, and each time that it passes the threshold.
void BusRecorder::follow_patient(std::int64_t now_us) {
  const auto moved = [](const NavigationRequest& sensor) {
    return sensor.patient_motion_um < 0 || sensor.patient_motion_um > safety::kPatientMotion_um;
  };
  NavigationRequest next;
  while (sensors_.take(next)) {
    if (next.measures_patient != sensor_.measures_patient || moved(next) != moved(sensor_))
      write(RecordKind::Alarm, "navigation",
            json_text({{"patient_measured", next.measures_patient},
                       {"patient_motion_mm", next.patient_motion_um * 1e-3}}),
            Urgency::Grouped, now_us);
    sensor_ = next;
  }
}

void BusRecorder::follow_stage(std::int64_t now_us) {
  Measurement next;
  while (measurements_.take(next)) {
    if (refuses(next.verdict) != refuses(measured_.verdict) || next.hv_enabled != measured_.hv_enabled)
      write(RecordKind::PermitChange, "stage",
            json_text({{"gate", static_cast<int>(next.verdict)},
                       {"hv_enabled", next.hv_enabled},
                       {"command_kV", next.command_mV * 1e-6},
                       {"depth_mm", next.depth_um * 1e-3},
                       {"seq", next.seq}}),
            Urgency::Grouped, now_us);
    measured_ = next;
    measured_us_ = now_us;
  }
  DriveRequest asked;
  while (requests_.take(asked)) {
    if (asked.step != request_.step || asked.step_reached != request_.step_reached ||
        asked.finished != request_.finished)
      write(RecordKind::Request, "controller",
            json_text(
                {{"stage", asked.step + 1}, {"reached", asked.step_reached}, {"finished", asked.finished}}),
            Urgency::Grouped, now_us);
    request_ = asked;
    requested_us_ = now_us;
  }
}

void BusRecorder::follow_health(std::int64_t now_us) {
  board_.update(now_us);
  for (std::size_t i = 0; i < kCount<Process>; ++i) {
    const Health health = board_.of(static_cast<Process>(i), now_us);
    const bool alive = health.seq != 0;
    const bool is_person = static_cast<Process>(i) == Process::Person;
    if (alive != alive_[i]) {
      LogBody body{{"alive", alive}, {"config", fmt::format("{:016x}", health.config_tag)}};
      if (is_person && alive) body["operator"] = health.note;
      write(alive ? RecordKind::ProcessStart : RecordKind::ProcessStop, name_of(static_cast<Process>(i)),
            json_text(body), Urgency::Urgent, now_us);
    }
    alive_[i] = alive;
    if (alive && health.refused != refused_[i])
      write(RecordKind::Alarm, name_of(static_cast<Process>(i)),
            json_text({{"strangers_refused", health.refused}}), Urgency::Grouped, now_us);
    if (alive) refused_[i] = health.refused;
    if (alive && !is_person && health.note != notes_[i])  // a person's note is who operates
      write(RecordKind::Alarm, name_of(static_cast<Process>(i)), json_text({{"note", health.note}}),
            Urgency::Grouped, now_us);
    if (alive) notes_[i] = health.note;
    if (alive && is_person) operator_name_ = health.note;
  }
}

void BusRecorder::follow_participants(std::int64_t now_us) {
  if (participants_ == nullptr) return;
  const int endpoints = participants_->unauthenticated_endpoints();
  if (endpoints != endpoints_)
    write(RecordKind::Alarm, "recorder", json_text({{"endpoints_without_keys", endpoints}}), Urgency::Grouped,
          now_us);
  endpoints_ = endpoints;
  const int outside = participants_->unauthenticated_participants();
  if (outside != outside_) outside_us_ = now_us;
  outside_ = outside;
  if (outside_ == told_outside_ || now_us - outside_us_ < kAuthentication_us) return;
  write(RecordKind::Alarm, "recorder", json_text({{"participants_not_let_in", outside_}}), Urgency::Grouped,
        now_us);
  told_outside_ = outside_;
}

// A log that receives nothing is not up to date, however little waits to be written.
std::int64_t BusRecorder::unheard_ms(std::int64_t now_us) const {
  const std::int64_t since_us = std::min({decision_us_, measured_us_, requested_us_});
  return since_us == 0 ? kNever_ms : (now_us - since_us) / 1000;
}

// Lost liveliness and missed deadlines, as reported by the bus.
void BusRecorder::follow_liveliness(std::int64_t now_us) {
  if (now_us - lively_us_ < kLivelyEvery_us) return;
  lively_us_ = now_us;
  const std::array<Lively, 3> now{
      {{"Decision", decisions_.alive_writers(), decisions_.missed_deadlines()},
       {"Measurement", measurements_.alive_writers(), measurements_.missed_deadlines()},
       {"DriveRequest", requests_.alive_writers(), requests_.missed_deadlines()}}};
  for (std::size_t i = 0; i < now.size(); ++i)
    if (now[i].alive != lively_[i].alive || now[i].missed != lively_[i].missed)
      write(RecordKind::Alarm, "recorder",
            json_text({{"topic", now[i].topic},
                       {"writers_alive", now[i].alive},
                       {"deadlines_missed", now[i].missed}}),
            Urgency::Grouped, now_us);
  lively_ = now;
}

void BusRecorder::report_itself(std::int64_t now_us) {
  heartbeat_.note(recorder_.last_error());
  heartbeat_.beat(now_us);
  if (now_us - reported_us_ < kReportEvery_us) return;
  reported_us_ = now_us;
  log_health_.write({.seq = ++health_seq_,
                     .backlog_ms = static_cast<std::int32_t>(std::clamp<std::int64_t>(
                         unheard_ms(now_us), recorder_.backlog_ms(now_us), kNever_ms)),
                     .records = recorder_.written().count});
}

void BusRecorder::turn(std::int64_t now_us) {
  follow_health(now_us);  // first: it says who operates
  follow_decisions(now_us);
  follow_acts(now_us);
  follow_plan_and_checks(now_us);
  follow_patient(now_us);
  follow_stage(now_us);
  follow_participants(now_us);
  follow_liveliness(now_us);
  recorder_.poll(now_us);
  report_itself(now_us);
}

}  // namespace biopsy::robot
