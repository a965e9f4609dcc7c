#include "robot/ros2/diagnostics.hpp"

#include <fmt/format.h>

#include "robot/msg/enum_traits.hpp"
#include "safety/types/hazards.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::ros2 {
namespace {

std::string hazard(std::uint8_t code) {
  return std::string(safety::name_of(static_cast<safety::Hazard>(code)));
}

DiagnosticLevel level_of(Mode mode) {
  switch (mode) {
    case Mode::Trip:
    case Mode::Lock:
      return DiagnosticLevel::Error;
    case Mode::Hold:
    case Mode::Retract:
      return DiagnosticLevel::Warn;
    default:
      return DiagnosticLevel::Ok;
  }
}

Diagnostic supervisor_of(const std::optional<Decision>& decision) {
  Diagnostic diagnostic{.name = "biopsy: supervisor", .message = "silent", .values = {}};
  if (!decision) return diagnostic;
  diagnostic.level = level_of(decision->mode);
  diagnostic.message = safety::name_of(decision->mode);
  diagnostic.values = {{"reason", hazard(decision->reason)},
                       {"worst hazard", hazard(decision->worst)},
                       {"stop category", std::string(name_of(decision->stop))},
                       {"step", std::to_string(decision->step + 1)},
                       {"step done", decision->step_done ? "true" : "false"},
                       {"session", std::to_string(decision->session)}};
  return diagnostic;
}

Diagnostic needle_of(const RobotState& state) {
  Diagnostic diagnostic{.name = "biopsy: needle", .message = "stage silent", .values = {}};
  if (!state.measurement) return diagnostic;
  const Measurement& measured = *state.measurement;
  diagnostic.level = measured.laser_valid ? DiagnosticLevel::Ok : DiagnosticLevel::Error;
  diagnostic.message = !measured.laser_valid ? "depth sensor invalid: depth is not published"
                       : state.X_SR          ? "measured"
                                             : "measured; no sealed plan: pose is not published";
  diagnostic.values = {{"depth [mm]", fmt::format("{:.3f}", measured.depth_um * 1e-3)},
                       {"voltage monitor [kV]", fmt::format("{:.3f}", measured.monitor_mV * 1e-6)},
                       {"current monitor [uA]", fmt::format("{:.3f}", measured.current_nA * 1e-3)},
                       {"HV enabled", measured.hv_enabled ? "true" : "false"},
                       {"brake on", measured.brake_on ? "true" : "false"}};
  return diagnostic;
}

Diagnostic process_of(Process process, const Health& health) {
  Diagnostic diagnostic{
      .name = fmt::format("biopsy: process {}", name_of(process)), .message = "silent", .values = {}};
  if (health.seq == 0) return diagnostic;
  diagnostic.level = health.ready ? DiagnosticLevel::Ok : DiagnosticLevel::Warn;
  diagnostic.message = health.ready ? "ready" : "not ready";
  diagnostic.values = {{"missed periods", std::to_string(health.overruns)},
                       {"late, median [us]", std::to_string(health.late_p50_us)},
                       {"late, 99 % [us]", std::to_string(health.late_p99_us)},
                       {"late, longest [us]", std::to_string(health.late_max_us)},
                       {"unauthenticated messages", std::to_string(health.refused)},
                       {"configuration", fmt::format("{:016x}", health.config_tag)}};
  // A person's note is a name.
  if (process != Process::Person) diagnostic.values.emplace_back("note", health.note);
  return diagnostic;
}

}  // namespace

std::vector<Diagnostic> diagnostics_of(const RobotState& state) {
  std::vector<Diagnostic> all{supervisor_of(state.decision), needle_of(state)};
  for (const Process process : {Process::Recorder, Process::Supervisor, Process::Stage, Process::Controller})
    all.push_back(process_of(process, state.health[static_cast<std::size_t>(process)]));
  for (const Process process : {Process::Person, Process::Navigation})
    if (const Health& health = state.health[static_cast<std::size_t>(process)]; health.seq != 0)
      all.push_back(process_of(process, health));
  return all;
}

}  // namespace biopsy::ros2
