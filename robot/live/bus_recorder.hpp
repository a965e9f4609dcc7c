// Records the traffic of the bus in the procedure log: changes only, never every tick.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "robot/live/heartbeat.hpp"
#include "robot/msg/fixed_messages.hpp"
#include "robot/recorder/recorder.hpp"
#include "robot/transport/bus.hpp"
#include "robot/transport/participant_monitor.hpp"

namespace biopsy::robot {

class BusRecorder {
 public:
  // `participants`: monitor of a secured bus; null on a bus without security.
  BusRecorder(const transport::Participant& bus, recorder::Recorder& recorder, std::uint64_t config_tag,
              const transport::ParticipantMonitor* participants);

  // Takes all messages and writes the records that are due; every 10 ms.
  void turn(std::int64_t now_us);

  const Health& health() { return heartbeat_.health(); }

  // The recorder's own start and end.
  void note(recorder::RecordKind kind, const std::string& body, std::int64_t now_us);

 private:
  void write(recorder::RecordKind kind, std::string_view source, std::string body, recorder::Urgency urgency,
             std::int64_t now_us);
  void follow_decisions(std::int64_t now_us);
  void follow_acts(std::int64_t now_us);
  void follow_plan_and_checks(std::int64_t now_us);
  void follow_patient(std::int64_t now_us);
  void follow_stage(std::int64_t now_us);
  void follow_health(std::int64_t now_us);
  void follow_participants(std::int64_t now_us);
  void follow_liveliness(std::int64_t now_us);
  void report_itself(std::int64_t now_us);
  std::int64_t unheard_ms(std::int64_t now_us) const;  // longest silence of the required topics

  recorder::Recorder& recorder_;
  const transport::ParticipantMonitor* participants_;
  transport::Reader<Decision> decisions_;
  transport::Reader<OperatorAct> acts_;
  transport::Reader<SealedPlan> plans_;
  transport::Reader<PlanConfirmation> confirmations_;
  transport::Reader<DepthVerdictNote> verdicts_;
  transport::Reader<NavigationRequest> sensors_;
  transport::Reader<Measurement> measurements_;
  transport::Reader<DriveRequest> requests_;
  transport::Writer<LogHealth> log_health_;
  live::Heartbeat heartbeat_;
  live::HealthBoard board_;
  struct Lively {  // of a topic
    const char* topic = "";
    int alive = 0;
    std::uint32_t missed = 0;
  };
  std::array<Lively, 3> lively_{};
  std::int64_t lively_us_ = 0;
  Decision decision_;
  OperatorAct act_;
  NavigationRequest sensor_;
  Measurement measured_;
  DriveRequest request_;
  Decision last_refused_;
  std::int64_t decision_us_ = 0, measured_us_ = 0, requested_us_ = 0;  // of the newest
  std::array<bool, kCount<Process>> alive_{};
  std::array<std::uint32_t, kCount<Process>> refused_{};
  std::array<std::string, kCount<Process>> notes_;
  std::string operator_name_;  // the note of the person's process
  int endpoints_ = 0;
  int outside_ = 0, told_outside_ = 0;
  std::int64_t outside_us_ = 0;
  std::uint32_t health_seq_ = 0;
  std::int64_t reported_us_ = 0;
};

}  // namespace biopsy::robot
