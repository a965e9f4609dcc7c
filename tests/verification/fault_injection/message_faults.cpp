// Messages lost, repeated, swapped and replayed; parts that stop altogether; a scanner that runs meanwhile.
#include <algorithm>
#include <deque>
#include <memory>

#include "tests/safety/situation.hpp"
#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {
namespace {

using safety::bit;
using safety::Hazard;

// Shown as R-26 counts: a number out of order is 2, one in order -1, above 2 is wrong. One slip is forgiven.
auto out_of_order(const Procedure& procedure) {
  return [newest = procedure.last().measurement.seq, score = 0](const ObservedTick& s) mutable {
    const std::uint32_t seq = s.seen.measurement.seq;
    score = seq == newest + 1 ? std::max(score - 1, 0) : seq != newest ? score + 2 : score;
    if (seq > newest) newest = seq;
    return score > 2;
  };
}

// One to three in a row do not arrive, one does, and again.
Corruptors lose(Draw& draw, Procedure& procedure, const TickRecord&) {
  return {.observation =
              [draw, old = procedure.last().measurement,
               lost = draw.whole(1, 3)](safety::SupervisorInputs& seen) mutable {
                if (lost-- > 0) {
                  seen.measurement = old;
                } else {
                  old = seen.measurement;
                  lost = draw.whole(1, 3);
                }
              },
          .shows = out_of_order(procedure)};
}

// Messages that came before, two to twenty back, come again in place of the newest.
Corruptors repeat(Draw& draw, Procedure& procedure, const TickRecord&) {
  return {
      .observation =
          [draw, past = std::deque<Measurement>{}](safety::SupervisorInputs& seen) mutable {
            past.push_front(seen.measurement);
            if (past.size() > 21) past.pop_back();
            if (past.size() > 3)
              seen.measurement =
                  past[static_cast<std::size_t>(draw.whole(2, static_cast<std::int32_t>(past.size()) - 1))];
          },
      .shows = out_of_order(procedure)};
}

// Pairs change places: the second is in time, the first comes after it.
Corruptors swap(Draw&, Procedure& procedure, const TickRecord&) {
  const Measurement last = procedure.last().measurement;
  return {.observation =
              [late = last, now = last, second = false](safety::SupervisorInputs& seen) mutable {
                late = now;
                now = seen.measurement;
                if (!second) seen.measurement = late.seq > 0 ? late : now;
                second = !second;
              },
          .shows = out_of_order(procedure)};
}

// A stretch is recorded, and played back for ever.
Corruptors replay(Draw& draw, Procedure& procedure, const TickRecord&) {
  return {.observation =
              [length = static_cast<std::size_t>(draw.whole(10, 200)), next = std::size_t{0},
               record = std::vector<Measurement>{}](safety::SupervisorInputs& seen) mutable {
                if (record.size() < length)
                  record.push_back(seen.measurement);
                else
                  seen.measurement = record[next++ % length];
              },
          .shows = out_of_order(procedure)};
}

Corruptors disorder(Draw& draw, Procedure& procedure, const TickRecord& now) {
  constexpr Inject kWays[] = {lose, repeat, swap, replay};
  return kWays[draw.whole(0, 3)](draw, procedure, now);
}

// Permits and requests of a motion are recorded; once it was stopped they come again, and only they.
Corruptors replay_to_gate(Draw& draw, Procedure&, const TickRecord&) {
  struct Tape {
    std::vector<Permit> permits;
    std::vector<DriveRequest> requests;
    std::size_t length, next = 0;
    bool is_full() const { return permits.size() == length; }
  };
  auto tape = std::make_shared<Tape>();
  tape->length = static_cast<std::size_t>(draw.whole(10, 200));
  const StopCategory stop = draw.coin() ? StopCategory::C0Off : StopCategory::C1Ramp;
  return {.world =
              [=](robot::OperatorInputs& world) {
                if (tape->is_full()) world.stop = stop;
              },
          .delivery =
              [=](robot::GateInputs& d) {
                if (tape->is_full()) {
                  d.permit = tape->permits[tape->next % tape->length];
                  d.request = tape->requests[tape->next++ % tape->length];
                } else {
                  tape->permits.push_back(d.permit);
                  tape->requests.push_back(d.request);
                }
              },
          .shows = [=](const ObservedTick&) { return tape->is_full(); }};
}

Corruptors stop_supervisor(Draw&, Procedure&, const TickRecord&) {
  return {.delivery = [](robot::GateInputs& d) { d.permit = {}; }};
}

// The driver stands; its converter holds the last voltage, and nothing more is measured.
Corruptors stop_driver(Draw&, Procedure& procedure, const TickRecord&) {
  return {.driver_stopped = true,
          .observation = [old = procedure.last().measurement](safety::SupervisorInputs& seen) {
            seen.measurement = old;
          }};
}

Corruptors silence_console(Draw&, Procedure&, const TickRecord&) {
  return {.input = [](safety::Situation& input) { input.motion = {}; }};
}

// The button was let go and the motion is on hold; heartbeats of it arrive late, again and again.
Corruptors press_late(Draw& draw, Procedure&, const TickRecord&) {
  const auto back = static_cast<std::uint32_t>(draw.whole(0, 3));
  return {.input = [back, newest = 0U](safety::Situation& input) mutable {
    const bool lets_go = newest == 0;
    newest = std::max(newest, input.motion.token);
    const std::uint32_t late = newest > back ? newest - back : newest;
    input.motion = lets_go ? safety::MotionPress{newest, false} : safety::MotionPress{late, true};
  }};
}

Corruptors scan_meanwhile(Draw&, Procedure&, const TickRecord&) {
  return {.world = [](robot::OperatorInputs& world) { world.acquiring = true; },
          .shows = [](const ObservedTick& s) { return s.seen.acquiring && s.disturbing; }};
}

FaultClass way_of(Hazard hazard, const char* way, const char* what, Inject inject) {
  FaultClass fault = class_of(hazard);
  fault.id += way;
  fault.what = what;
  fault.modes = kReadyOrDriven;
  fault.inject = inject;
  fault.instead = bit(Hazard::SensorStale);
  return fault;
}

FaultClass unnamed(const char* id, const char* what, Reaction reaction, std::int32_t react_ms,
                   std::vector<Mode> modes, Inject inject) {
  FaultClass fault;
  fault.id = id;
  fault.what = what;
  fault.reaction = reaction;
  fault.detect_ms = fault.react_ms = react_ms;
  fault.modes = std::move(modes);
  fault.inject = inject;
  return fault;
}

}  // namespace

std::vector<FaultClass> message_faults() {
  FaultClass any = class_of(Hazard::MessageOrder, kReadyOrDriven, disorder);
  any.instead = bit(Hazard::SensorStale);
  return {any,
          way_of(Hazard::MessageOrder, "/loss", "measurements lost", lose),
          way_of(Hazard::MessageOrder, "/repeat", "older measurements again", repeat),
          way_of(Hazard::MessageOrder, "/swap", "measurements change places", swap),
          way_of(Hazard::MessageOrder, "/replay", "a stretch of measurements played back", replay),
          unnamed("gate/replay", "permits and requests of before a stop", Reaction::OutputOff, 5,
                  {Mode::Active}, replay_to_gate),
          unnamed("gate/supervisor", "supervisor dead: no permit", Reaction::OutputOff, 5, kDriven,
                  stop_supervisor),
          unnamed("interlock/driver", "driver stopped, its output stays", Reaction::OutputOff, 21, kDriven,
                  stop_driver),
          unnamed("console/silent", "console silent, button held", Reaction::NoRise, 101, {Mode::Active},
                  silence_console),
          unnamed("console/late", "heartbeats of a press that ended", Reaction::NoRise, 2, {Mode::Active},
                  press_late),
          unnamed("image/switching", "high voltage switched while an image is taken", Reaction::Flag, 1,
                  {Mode::Active, Mode::Hold}, scan_meanwhile)};
}

}  // namespace biopsy::fault_injection
