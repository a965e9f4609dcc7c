#include "robot/procedure/fault_notes.hpp"

#include <cmath>

#include "safety/types/hazards.hpp"

namespace biopsy::robot {
namespace {

// At the start nothing is known yet, which counts as every hazard: evidence of a sound robot is complete by
// then.
constexpr std::int64_t kStart_ticks = 500;

}  // namespace

FaultNotes::FaultNotes(const std::vector<sim::Fault>& faults) : before_(faults.size()) {
  for (const sim::Fault& fault : faults)
    results_.push_back(
        {.signal = std::string(name_of(fault.signal)), .kind = std::string(name_of(fault.kind))});
}

void FaultNotes::add(const CycleRecord& tick, std::uint32_t active) {
  const double now_s = static_cast<double>(ticks_) * 1e-3;
  const safety::HazardSet found = ticks_ < kStart_ticks ? 0 : tick.evidence.hazards();
  for (std::size_t i = 0; i < results_.size(); ++i) {
    report::FaultResult& result = results_[i];
    if (std::isnan(result.began_s)) {
      if ((active >> i & 1U) == 0) continue;
      result.began_s = now_s;
      before_[i] = last_;
    }
    const safety::HazardSet fresh = found & ~before_[i];
    const bool held_too_long = tick.supervisor.event == safety::Event::HoldTooLong;
    if (!result.detected_by.empty() || (fresh == 0 && !held_too_long)) continue;
    result.detected_by = fresh != 0 ? name_of(safety::worst_of(fresh)) : name_of(tick.supervisor.event);
    result.detected_after_ms = (now_s - result.began_s) * 1e3;
  }
  last_ = found;
  ++ticks_;
}

void FaultNotes::finish(report::RunRecord& record) const {
  record.faults = results_;
  for (report::FaultResult& result : record.faults)
    for (const report::StepResult& step : record.steps) {
      const bool refused = step.check && step.check->verdict != DepthVerdict::Accept;
      if (!refused || !(step.image_s >= result.began_s)) continue;
      const double after_ms = (step.image_s - result.began_s) * 1e3;
      if (!result.detected_by.empty() && result.detected_after_ms <= after_ms) continue;
      result.detected_by = "depth check";
      result.detected_after_ms = after_ms;
    }
}

}  // namespace biopsy::robot
