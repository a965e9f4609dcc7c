// The person's side of the live robot: hears every tick, and keeps saying what the person does.
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
#include "robot/procedure/rehearsal.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::robot {

// A thread of its own talks to the bus, so that a person who looks at an image for seconds misses no tick and
// lets no message grow old.
class LiveRobot {
 public:
  // `panel`: the lines whose keys this person turns, on a simulated device; empty: real keys, which are not
  // ours.
  LiveRobot(const transport::Participant& bus, const std::filesystem::path& panel, std::uint64_t config_tag);
  ~LiveRobot();
  LiveRobot(const LiveRobot&) = delete;
  LiveRobot& operator=(const LiveRobot&) = delete;

  void send_plan(const Plan& plan, const std::array<std::uint64_t, 2>& confirmed);

  // Does what `world` says from now on, and returns the next tick in order. Nothing: none came for a second.
  std::optional<CycleSample> tick(const World& world);

  // A needle that is still driven is let back gently: before the processes are brought down.
  void let_back();

  // The health of every process, newest.
  std::array<Health, kCount<Process>> health() const;
  // Ticks that did not reach us.
  std::uint64_t lost() const { return lost_.load(); }

 private:
  void listen(const std::stop_token& stop);
  void speak(std::int64_t now_us);
  void gather();
  CycleSample beat_of(const Measurement& next) const;

  std::optional<digital_io::PanelIo> panel_;
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

  // Of the thread alone
  Measurement measured_;
  Permit permit_;
  Decision decision_;
  DriveRequest request_;
  StageTruth truth_;
  OperatorAct said_;
  DepthVerdictNote judged_;
  std::int64_t spoken_us_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::deque<CycleSample> beats_;
  World world_;
  std::int64_t asked_us_ = 0;  // when it was last said
  std::uint64_t plan_tag_ = 0;
  std::uint32_t plans_sent_ = 0;
  std::array<Health, kCount<Process>> health_{};
  std::atomic<std::uint64_t> lost_{0};
  std::jthread thread_;  // last: everything it uses is there
};

}  // namespace biopsy::robot
