#include "safety/monitors/evidence.hpp"

namespace biopsy::safety {

Evidence assess(const PlanFacts& plan, EvidenceMemory& memory, const SupervisorInputs& seen) {
  const LinkFindings link = update(plan, memory.link, seen);
  const bool answers = link.fresh && (link.found & bit(Hazard::WrongAnswer)) == 0;
  const PanelFindings panel = update(memory.panel, seen, answers);
  const bool stale = (link.found & bit(Hazard::SensorStale)) != 0;
  const DriveFindings drive = update(plan, memory.drive, seen, link.fresh, stale);
  const DepthFindings depth = update(plan, memory.depth, seen, link, drive.zero_volts);
  const HazardSet agreement = update(plan, memory.agreement, seen.measurement, link.fresh);
  Evidence evidence;
  evidence.clear = ~(link.found | panel.found | drive.found | depth.found | agreement) & kAllHazards;
  evidence.interlock_opens = panel.interlock_opens;
  evidence.estop_reset = panel.reset;
  evidence.elapsed_ms = link.elapsed_ms;
  evidence.zero_volts = drive.zero_volts;
  evidence.needle_home = depth.needle_home;
  evidence.needle_back = depth.needle_back;
  evidence.locked = depth.locked;
  evidence.still = depth.still && drive.zero_volts;
  evidence.image_disturbed = drive.image_disturbed || (seen.acquiring && depth.locked && !depth.still);
  evidence.drive_mV = drive.drive_mV;
  evidence.ceiling_mV = drive.ceiling_mV;
  return evidence;
}

}  // namespace biopsy::safety
