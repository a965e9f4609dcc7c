#include "safety/monitors/panel_monitor.hpp"

#include "safety/monitors/clock_step.hpp"
#include "safety/monitors/debounce.hpp"
#include "safety/types/thresholds.hpp"
#include "safety/types/transitions.hpp"

namespace biopsy::safety {
namespace {

using Test = PanelMonitor::Test;

HazardSet check_contacts(PanelMonitor& monitor, const SupervisorInputs& seen) {
  const bool differs = seen.estop_a_closed != seen.estop_b_closed;
  monitor.differs_ticks = debounced(monitor.differs_ticks, differs, kEStopDisagree_ticks + 1);
  if (monitor.differs_ticks > kEStopDisagree_ticks) monitor.differed = true;
  const bool latched = monitor.differed;
  const bool both_open = !seen.estop_a_closed && !seen.estop_b_closed;
  if (seen.panel_read && both_open) monitor.differed = false;  // both work again: from the next tick
  return when(latched, Hazard::EStopDisagrees);
}

void advance(PanelMonitor& monitor, const SupervisorInputs& seen, bool turned) {
  const bool closed = seen.estop_a_closed && seen.estop_b_closed;
  const bool open = seen.panel_read && !seen.estop_a_closed && !seen.estop_b_closed;
  if (monitor.test == Test::None && closed) monitor.test = Test::Closed;
  if (monitor.test != Test::None && open)
    monitor.test = Test::Pressed;  // after a test as well: a press is one
  if (monitor.test == Test::Pressed && closed && turned && !seen.local_arm)
    monitor.test = Test::Passed, monitor.tested_us = seen.now_us;
}

void check_keys(PanelMonitor& monitor, const SupervisorInputs& seen) {
  const bool turned = seen.local_arm || seen.local_reset;
  if (!turned || hv_permitted(seen.permit.mode)) monitor.keys_open_us = seen.now_us;
  if (!is_less_than_after(monitor.keys_open_us, seen.now_us, kKeyStuck_us)) monitor.test = Test::None;
}

HazardSet check_relay(PanelMonitor& monitor, const SupervisorInputs& seen, bool answers,
                      PanelFindings& findings) {
  const Mode mode = seen.permit.mode;
  const bool fed_by_both = mode == Mode::Ready || hv_permitted(mode);
  monitor.relay_ticks = debounced(monitor.relay_ticks, seen.relay_closed != fed_by_both, kRelay_ticks + 1);
  const bool alone = answers && !seen.relay_closed;
  if (mode == Mode::Boot) monitor.open_ticks = debounced(monitor.open_ticks, alone, kRelay_ticks);
  findings.interlock_opens = monitor.open_ticks >= kRelay_ticks;
  return when(monitor.relay_ticks > kRelay_ticks, Hazard::InterlockStuck);
}

}  // namespace

PanelFindings update(PanelMonitor& monitor, const SupervisorInputs& seen, bool answers) {
  PanelFindings findings;
  findings.found = check_contacts(monitor, seen) | check_relay(monitor, seen, answers, findings);
  const bool turned = seen.local_reset && !monitor.reset_was_down;
  monitor.reset_was_down = seen.local_reset;
  const bool pressed = !seen.panel_read || !seen.estop_a_closed || !seen.estop_b_closed;
  advance(monitor, seen, turned);
  check_keys(monitor, seen);
  findings.reset = !pressed && turned && monitor.pressed;
  if (pressed) monitor.pressed = true;
  if (!pressed && turned) monitor.pressed = false;
  const bool due =
      !hv_permitted(seen.permit.mode) && !is_less_than_after(monitor.tested_us, seen.now_us, kPanelTest_us);
  findings.found |=
      when(monitor.pressed, Hazard::EStop) | when(monitor.test != Test::Passed || due, Hazard::PanelUntested);
  return findings;
}

}  // namespace biopsy::safety
