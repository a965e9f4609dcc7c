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
    monitor.differ_ticks = debounced(monitor.differ_ticks, differs(measured), kDiffer_ticks);
  monitor.dropout_ticks = debounced(monitor.dropout_ticks, !measured.laser_b_valid, kDropout_ticks);
  monitor.found = 0;
  if (!is_for_patient(plan)) return monitor.found;
  monitor.found = when(monitor.differ_ticks >= kDiffer_ticks, Hazard::OffsetOrScale) |
                  when(monitor.dropout_ticks >= kDropout_ticks, Hazard::LaserDropout);
  return monitor.found;
}

}  // namespace biopsy::safety
