// What breaks in clocks, writers, answers, requests, buttons and the log.
#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "safety/challenge.hpp"
#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {
namespace {

using safety::Hazard;

Corruptors press_estop(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t contacts = draw.whole(1, 3);  // one works, or the other, or both
  return {.observation = [=](safety::SupervisorInputs& seen) {
    if ((contacts & 1) != 0) seen.estop_a_closed = false;
    if ((contacts & 2) != 0) seen.estop_b_closed = false;
  }};
}

// One contact opens, and may close again: the disagreement stays known.
Corruptors split_estop(Draw& draw, Procedure&, const TickRecord&) {
  const bool first = draw.coin();
  const std::int32_t heals = draw.coin() ? draw.whole(21, 60) : std::numeric_limits<std::int32_t>::max();
  return {.observation =
              [=, tick = 0](safety::SupervisorInputs& seen) mutable {
                const bool open = tick < heals;
                tick += open;
                (first ? seen.estop_a_closed : seen.estop_b_closed) = !open;
              },
          .shows = [](const ObservedTick& s) { return s.seen.estop_a_closed != s.seen.estop_b_closed; }};
}

// The relay drops out or its feedback wire breaks. Where nobody feeds it, it is open without a fault.
Corruptors open_relay(Draw&, Procedure&, const TickRecord&) {
  return {.observation = [](safety::SupervisorInputs& seen) { seen.relay_closed = false; },
          .shows =
              [](const ObservedTick& s) {
                return s.seen.permit.mode == Mode::Ready || safety::hv_permitted(s.seen.permit.mode);
              }};
}

// Somebody leans on the button and lets go: the panel has to be reset before it counts as tested again.
Corruptors touch_estop(Draw& draw, Procedure&, const TickRecord&) {
  return {.observation = [tick = 0, ticks = draw.whole(1, 500)](safety::SupervisorInputs& seen) mutable {
    if (tick++ < ticks) seen.estop_a_closed = seen.estop_b_closed = false;
  }};
}

// A clock jumps ahead by more than 5 ms or does not go on; the supervisor's, the stage's or the gate's.
Corruptors jump_clock(Draw& draw, Procedure&, const TickRecord&) {
  Corruptors corrupt;
  const std::int64_t by_us = draw.coin() ? draw.whole(4'001, 5'000'000) : -draw.whole(1'000, 5'000'000);
  switch (draw.whole(0, 2)) {
    case 0:
      corrupt.observation = [=](safety::SupervisorInputs& seen) { seen.now_us += by_us; };
      break;
    case 1:
      corrupt.reading = [=](drivers::SensorReading& r) { r.time_us += by_us; };
      break;
    default:
      corrupt.delivery = [=](robot::GateInputs& d) { d.now_us += by_us; };
      corrupt.shows = [](const ObservedTick& s) {
        return s.seen.measurement.verdict == GateVerdict::ClockJump;
      };
  }
  return corrupt;
}

// A driver whose arithmetic broke, that stands, that never answers, or whose output is not what it reports.
Corruptors answer_wrong(Draw& draw, Procedure& procedure, const TickRecord&) {
  const std::int32_t way = draw.whole(0, 3);
  const auto flaw = static_cast<std::uint32_t>(draw.whole(1, std::numeric_limits<std::int32_t>::max() - 1));
  return {.observation = [way, flaw, old = procedure.last().measurement](safety::SupervisorInputs& seen) {
    Measurement& m = seen.measurement;
    if (way == 0) m.answer ^= flaw;
    if (way == 1) m.answer = m.answered_seq = 0;
    if (way == 2) m.answer = old.answer, m.answered_seq = old.answered_seq;
    if (way == 3)
      m.answer = safety::answer_to(safety::challenge_of(seen.permit.session, m.answered_seq),
                                   m.command_mV + static_cast<std::int32_t>(flaw % 16'000'000) + 1,
                                   seen.permit.mode, m.answered_seq);
  }};
}

Corruptors add_writer(Draw& draw, Procedure&, const TickRecord&) {
  Corruptors corrupt;
  const std::array kCounts{0, 2, 3, 7};
  const std::int32_t count = kCounts[static_cast<std::size_t>(draw.whole(0, 3))];
  const std::int32_t who = draw.whole(1, 3);  // supervisor, gate, or both see it
  if ((who & 1) != 0) corrupt.observation = [=](safety::SupervisorInputs& seen) { seen.writers = count; };
  if ((who & 2) != 0) corrupt.delivery = [=](robot::GateInputs& d) { d.writers = count; };
  if (who == 2)
    corrupt.shows = [](const ObservedTick& s) {
      return s.seen.measurement.verdict == GateVerdict::SecondWriter;
    };
  return corrupt;
}

// Three periods missed within 100 ms: nothing is sent in them, and the next request reports them.
Corruptors overrun(Draw& draw, Procedure& procedure, const TickRecord&) {
  const std::array<std::int32_t, 3> missed{0, draw.whole(2, 45), draw.whole(47, 94)};
  return {.request =
              [=, old = procedure.last().request, tick = 0, count = 0U](DriveRequest& r) mutable {
                for (const std::int32_t at : missed) {
                  if (tick != at) continue;
                  ++count, ++tick;
                  r = old;
                  return;
                }
                ++tick;
                r.overruns += count;
                old = r;
              },
          .shows = [before = procedure.last().request.overruns](
                       const ObservedTick& s) { return s.seen.request.overruns >= before + 3; }};
}

Corruptors silence_controller(Draw& draw, Procedure& procedure, const TickRecord&) {
  const bool restarts = draw.coin();  // sends again, but counts from 1: not the controller that was trusted
  return {.request =
              [restarts, old = procedure.last().request, next = 1U](DriveRequest& r) mutable {
                if (restarts)
                  r.seq = next++;
                else
                  r = old;
              },
          .shows = [newest = 0U](const ObservedTick& s) mutable {  // the last sound one is still on its way
            const bool old = s.seen.request.seq <= newest;
            newest = std::max(newest, s.seen.request.seq);
            return old;
          }};
}

Corruptors stall_log(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t backlog_ms = draw.within(0.0, 1.0) < 0.1 ? -1 : draw.whole(1'001, 60'000);
  return {.environment = [=](robot::Environment& environment) { environment.log_backlog_ms = backlog_ms; }};
}

}  // namespace

std::vector<FaultClass> link_faults() {
  FaultClass split = class_of(Hazard::EStopDisagrees, kReadyOrDriven, split_estop);
  split.row = 21;
  FaultClass relay = class_of(Hazard::InterlockStuck, kReadyOrDriven, open_relay);
  relay.row = 31;
  relay.fits = [](const ProcedureState& s) { return s.left >= 31; };
  FaultClass untested = class_of(Hazard::PanelUntested, kReadyOrDriven, touch_estop);
  untested.instead = bit(Hazard::EStop);
  return {class_of(Hazard::EStop, kReadyOrDriven, press_estop),
          split,
          relay,
          untested,
          class_of(Hazard::ClockJump, kReadyOrDriven, jump_clock),
          class_of(Hazard::WrongAnswer, kReadyOrDriven, answer_wrong),
          class_of(Hazard::SecondWriter, kReadyOrDriven, add_writer),
          class_of(Hazard::LoopOverrun, kReadyOrDriven, overrun),
          class_of(Hazard::ControllerSilent, kReadyOrDriven, silence_controller),
          class_of(Hazard::LogBacklog, kReadyOrDriven, stall_log)};
}

}  // namespace biopsy::fault_injection
