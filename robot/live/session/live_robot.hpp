// The operator's side of the live robot: receives every tick, and keeps sending what the operator does.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "drivers/digital_io/io_views.hpp"
#include "robot/live/heartbeat.hpp"
#include "robot/live/session/panel_proof.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::robot {

// A thread of its own talks to the bus, so that no tick is missed and no message grows old while a program is
// busy for seconds, with an image for example.
class LiveRobot {
 public:
  // `panel`: the simulated device whose keys are turned here; empty: a real device has its own.
  LiveRobot(const transport::Participant& bus, const std::filesystem::path& panel, std::uint64_t config_tag);
  ~LiveRobot();
  LiveRobot(const LiveRobot&) = delete;
  LiveRobot& operator=(const LiveRobot&) = delete;

  void send_plan(const Plan& plan, const std::array<std::uint64_t, 2>& confirmed);

  // Sends `inputs` from now on, and returns the next tick in order; nothing where none came for a second.
  std::optional<CycleSample> tick(const OperatorInputs& inputs);

  // Ramps a needle that is still driven down to 0 V: before the processes are stopped.
  void retract();

  // The health of every process, newest.
  std::array<Health, kCount<Process>> health() const;
  // Ticks that were not received.
  std::uint64_t lost() const { return lost_.load(); }

 private:
  void listen(const std::stop_token& stop);
  void send(std::int64_t now_us);
  void gather();
  CycleSample cycle_of(const Measurement& next) const;

  std::optional<digital_io::PanelIo> panel_;
  PanelProof panel_proof_;
  transport::Reader<Measurement> measurements_;
  transport::Reader<Permit> permits_;
  transport::Reader<Decision> decisions_;
  transport::Reader<DriveRequest> requests_;
  transport::Reader<StageTruth> truths_;
  transport::Writer<OperatorAct> acts_;
  transport::Writer<SealedPlan> plans_;
  transport::Writer<DepthVerdictNote> verdicts_;
  transport::WaitSet wait_set_;
  live::Heartbeat heartbeat_;
  live::HealthBoard board_;

  // Used by the thread alone
  Measurement measured_;
  Permit permit_;
  Decision decision_;
  std::optional<Decision> passed_;  // of a ramp or trip that no tick has shown yet: at 0 V a ramp lasts one
  bool disturbed_ = false;          // the image, by a decision that no tick has shown yet
  DriveRequest request_;
  StageTruth truth_;
  OperatorAct act_;           // sent last
  DepthVerdictNote verdict_;  // sent last
  std::int64_t sent_us_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::deque<CycleSample> cycles_;
  OperatorInputs inputs_;
  std::int64_t asked_us_ = 0;  // when they were last given
  std::uint64_t plan_tag_ = 0;
  std::uint32_t plans_sent_ = 0;
  std::array<Health, kCount<Process>> health_{};
  std::atomic<std::uint64_t> lost_{0};
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace biopsy::robot
