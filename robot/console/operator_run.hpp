// One run, from arming to the return of the needle.
#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <string>

#include "robot/console/operator_session.hpp"

namespace biopsy::robot {

// How long a single command is repeated to the robot. The key: 20 ms for its contact, and the reading of the
// configuration's files.
inline constexpr std::int64_t kKeyTurned_us = 500'000;
inline constexpr std::int64_t kStopLasts_us = 500'000;  // longer than a C1 ramp, and any loss of messages

struct OperatorSession::Run {
  Run(const PreparedCase& planned, std::filesystem::path run_folder)
      : prepared(planned),
        folder(std::move(run_folder)),
        notes(prepared),
        images(prepared, std::get<Plan>(prepared.plan), folder) {}

  const PreparedCase prepared;  // as it was when the run began
  const std::filesystem::path folder;
  RunNotes notes;
  ConfirmationImages images;
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  bool moved = false, ended = false, completed = false;
  std::int64_t cold_since_us = 0;
  std::string stopped_because;  // by a person
  std::string ended_by;         // by the robot

  std::optional<std::size_t> imaged;         // step whose image was begun last
  std::optional<std::int64_t> acquiring_us;  // since when
  Permit imaged_under;                       // in force then
  bool locking = false;                      // the needle, before that
  std::future<report::StepResult> check;     // of step `imaged`
  std::optional<std::size_t> accepted;       // step
  std::optional<std::string> left_hold;      // why, of the hold at the end of step `imaged`
  bool patient_moved = false;                // in any tick since the needle arrived where it is held

  const Plan& plan() const { return std::get<Plan>(prepared.plan); }
  bool is_last(std::size_t step) const { return step + 1 >= plan().steps.size(); }
  // An image was checked and is not judged yet.
  bool is_undecided() const {
    return imaged && is_checked(*imaged) && accepted != imaged && stopped_because.empty();
  }
  bool is_checked(std::size_t step) const {
    const auto& steps = notes.record().steps;
    return step < steps.size() && steps[step].check.has_value();
  }
};

}  // namespace biopsy::robot
