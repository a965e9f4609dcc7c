#include "safety/monitors/agreement_monitor.hpp"

#include "safety/monitors/debounce.hpp"

namespace biopsy::safety {
namespace {

bool differs(const Measurement& m) {
  const std::int64_t apart = std::int64_t{m.depth_um} - m.depth_b_um;
  return apart > kDiffer_um || apart < -kDiffer_um;
}

}  // namespace

HazardSet update(const PlanFacts& plan, AgreementMonitor& monitor, const Measurement& measured, bool fresh) {
  if (!fresh) return monitor.found;
  // While one of the two is blind the count stands: the dropout has its own, and a flickering sensor hides
  // nothing.
  if (measured.laser_valid && measured.laser_b_valid)
    monitor.differ_score = accumulated(monitor.differ_score, differs(measured), kDifferWeight, kDiffer_ticks);
  monitor.dropout_score =
      accumulated(monitor.dropout_score, !measured.laser_b_valid, kComes_goes, kDropout_ticks);
  const HazardSet found = when(monitor.differ_score >= kDifferTrip, Hazard::OffsetOrScale) |
                          when(monitor.dropout_score >= kDropoutTrip, Hazard::LaserDropout);
  return monitor.found = is_for_patient(plan) ? found : 0;
}

}  // namespace biopsy::safety
