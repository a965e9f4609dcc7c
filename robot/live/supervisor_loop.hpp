// The supervisor process: gathers what one tick needs and calls the very functions that a rehearsal calls,
// once for each measurement, or once a millisecond where none come.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "drivers/digital_io/io_views.hpp"
#include "drivers/pulse_output.hpp"
#include "robot/cycle/supervise.hpp"
#include "robot/live/config_watch.hpp"
#include "robot/live/heartbeat.hpp"
#include "robot/transport/bus.hpp"

namespace biopsy::live {

class SupervisorLoop {
 public:
  // `session`: larger at every start. One that failed its self-test locks. `needs_second_person`: the console
  // cannot give both confirmations of a plan. `interlock`, this side's half of it, `panel` and `files` must
  // outlive this.
  SupervisorLoop(const transport::Participant& bus, drivers::PulseOutput& interlock,
                 const digital_io::IoReader& panel, const FilesTag& files, std::uint64_t config_tag,
                 std::uint32_t session, safety::SelfTest self_test, bool needs_second_person);

  // Waits for the next measurement or the next millisecond, and decides.
  void turn();

  Heartbeat& heartbeat() { return heartbeat_; }
  Mode mode() const { return supervisor_.state.mode; }

 private:
  // All that came since the last turn, in order: one tick each.
  struct Burst {
    static constexpr std::size_t kMost = 16;
    std::array<Measurement, kMost> measured;
    std::array<DriveRequest, kMost> requested;
    std::size_t measurements = 0, requests = 0;
  };
  void take_messages(std::int64_t now_us);
  void take_burst();
  void tick(std::int64_t now_us);
  robot::WriterCounts writers() const;

  drivers::PulseOutput& interlock_;
  const digital_io::IoReader& panel_;
  const FilesTag& files_;
  transport::Reader<Measurement> measurements_;
  transport::Reader<DriveRequest> requests_;
  transport::Reader<OperatorAct> acts_;
  transport::Reader<SealedPlan> plans_;
  transport::Reader<PlanConfirmation> confirmations_;
  transport::Reader<DepthVerdictNote> verdicts_;
  transport::Reader<LogHealth> log_;
  transport::Reader<NavigationRequest> navigation_;
  transport::Writer<Permit> permits_;
  transport::Writer<Decision> decisions_;
  transport::WaitSet wait_set_;
  Heartbeat heartbeat_;

  robot::SupervisorMemory supervisor_;
  robot::SupervisorSources sources_;
  Burst burst_;
  std::int64_t ticked_us_ = 0;
  bool measurement_late_ = false;
};

}  // namespace biopsy::live
