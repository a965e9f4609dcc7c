// What breaks between converter and stack: amplifier, monitors, driver, and the wave the controller asks for.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "safety/challenge.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/transitions.hpp"
#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {
namespace {

using safety::bit;
using safety::Hazard;

bool under_voltage(const ProcedureState& g) {
  return std::abs(g.drive_mV) > 1'000'000 && g.steady >= 3;
}

// Some of the charge stays on the stack when the drive goes, or leaks in where there must be none.
Corruptors keep_charge(Draw& draw, Procedure&, const TickRecord& now) {
  const double most_V = now.mode == Mode::Ready ? 1'000.0 : 1e-3 * std::abs(now.command_mV);
  const double kept_V = draw.within(105.0, std::min(most_V, 1'000.0));
  const double sign = now.command_mV < 0 ? -1.0 : 1.0;
  const std::int32_t way = draw.whole(0, 2);
  return {.world =
              [way](robot::OperatorInputs& world) {
                if (way == 0) world.stop = StopCategory::C0Off;
                if (way == 1) world.stop = StopCategory::C1Ramp;
                if (way == 2) world.finish = true;
              },
          .amplifier =
              [=](double asked_V, bool enabled, bool closed) {
                return enabled && closed && std::abs(asked_V) > kept_V ? asked_V : sign * kept_V;
              },
          .shows =
              [](const ObservedTick& s) {
                return !safety::hv_permitted(s.seen.permit.mode) &&
                       std::abs(s.seen.measurement.monitor_mV) > limits::kZeroVolt_mV;
              }};
}

Corruptors run_away(Draw& draw, Procedure&, const TickRecord&) {
  const double output_V = draw.either_sign(8'250.0, 11'000.0);
  return {.amplifier = [=](double, bool enabled, bool closed) { return enabled && closed ? output_V : 0.0; },
          .shows =
              [](const ObservedTick& s) {
                return std::abs(s.seen.measurement.monitor_mV) > limits::kMonitorTrip_mV;
              }};
}

// An arc draws its current along with the voltage. Shown where it exceeds 2 nF times the largest change of
// the last three ticks, and 1 mA.
Corruptors arc(Draw& draw, Procedure& procedure, const TickRecord&) {
  const auto arc_nA = static_cast<std::int32_t>(1e6 * draw.within(1.1, 20.0));
  return {.reading = [=](drivers::SensorReading& r) { r.current_nA += r.monitor_mV < 0 ? -arc_nA : arc_nA; },
          .shows =
              [before = procedure.last().measurement.command_mV,
               changes = std::array<double, 3>{}](const ObservedTick& s) mutable {
                changes = {std::abs(double{1.0} * s.seen.measurement.command_mV - before), changes[0],
                           changes[1]};
                before = s.seen.measurement.command_mV;
                return std::abs(s.seen.measurement.current_nA) >
                       2.0 * *std::ranges::max_element(changes) + 1e6;
              }};
}

double tolerance_mV(double drive_mV) {
  return std::max(100'000.0, 0.03 * std::abs(drive_mV));
}

// The monitor, or the amplifier itself, is off by more than 3 % and 100 V.
Corruptors disagree(Draw& draw, Procedure& procedure, const TickRecord&) {
  Corruptors corrupt;
  const double off = draw.either_sign(1.2, 4.0);
  if (draw.coin())
    corrupt.reading = [=](drivers::SensorReading& r) {
      r.monitor_mV += static_cast<std::int32_t>(off * tolerance_mV(r.monitor_mV));
    };
  else
    corrupt.amplifier = [=](double asked_V, bool enabled, bool closed) {
      return enabled && closed ? asked_V + 1e-3 * off * tolerance_mV(1e3 * asked_V) : 0.0;
    };
  corrupt.shows = [before = procedure.last().measurement.command_mV](const ObservedTick& s) mutable {
    const double now = s.seen.measurement.command_mV,
                 then = std::exchange(before, s.seen.measurement.command_mV);
    const double tolerance = tolerance_mV(std::max(std::abs(now), std::abs(then)));
    return s.seen.measurement.hv_enabled &&
           (s.seen.measurement.monitor_mV < std::min(now, then) - tolerance ||
            s.seen.measurement.monitor_mV > std::max(now, then) + tolerance);
  };
  return corrupt;
}

// A driver that goes its own way and answers every challenge as if that were right. Only the interlock can
// stop it.
Corruptors disobey(Draw& draw, Procedure& procedure, const TickRecord& now) {
  const double above_mV = procedure.last().supervisor.permit.v_max_mV + 1e3 * draw.within(210.0, 800.0);
  const double own_mV = now.mode == Mode::Retract ? now.command_mV : (draw.coin() ? 1 : -1) * above_mV;
  return {.amplifier = [=](double, bool, bool closed) { return closed ? 1e-3 * own_mV : 0.0; },
          .observation =
              [own_mV, first = true](safety::SupervisorInputs& seen) mutable {
                if (std::exchange(first, false)) return;  // reports what was put out before it broke
                Measurement& m = seen.measurement;
                m.command_mV = static_cast<std::int32_t>(own_mV);
                m.hv_enabled = true;
                m.answer = safety::answer_to(safety::challenge_of(seen.permit.session, m.answered_seq),
                                             m.command_mV, seen.permit.mode, m.answered_seq);
              },
          .shows =
              [](const ObservedTick& s) {
                return std::abs(s.seen.measurement.command_mV) > s.seen.permit.v_max_mV + 200'000 ||
                       s.seen.measurement.hv_enabled != s.seen.permit.hv_enable;
              }};
}

// The driver locks the needle without a permit for it, and says so.
Corruptors lock_unasked(Draw&, Procedure&, const TickRecord&) {
  return {.observation = [](safety::SupervisorInputs& seen) { seen.measurement.brake_on = true; },
          .shows = [](const ObservedTick& s) { return s.seen.measurement.brake_on && !s.seen.permit.brake; }};
}

bool in_motion(const ObservedTick& s) {
  return s.seen.permit.mode == Mode::Active && std::abs(s.seen.measurement.command_mV) >= 1'000'000;
}

Corruptors stick_polarity(Draw& draw, Procedure&, const TickRecord&) {
  const bool negative = draw.coin();
  return {.request = [=](DriveRequest& r) { r.wanted_mV = (negative ? -1 : 1) * std::abs(r.wanted_mV); },
          .shows =
              [same = 0, was = 0](const ObservedTick& s) mutable {
                const int polarity = s.seen.measurement.command_mV < 0 ? -1 : 1;
                same = polarity == was ? same + 1 : 1;
                was = polarity;
                return in_motion(s) && same > 250;
              }};
}

// Shown by the first half-period that is a fifth too short or too long.
Corruptors change_rate(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t half = draw.coin() ? draw.whole(50, 190) : draw.whole(310, 600);
  return {.request =
              [half, tick = 0](DriveRequest& r) mutable {
                r.wanted_mV = (tick++ / half % 2 == 0 ? 1 : -1) * std::abs(r.wanted_mV);
              },
          .shows =
              [same = 0, was = 0, flips = 0](const ObservedTick& s) mutable {
                const int polarity = s.seen.measurement.command_mV < 0 ? -1 : 1;
                const bool flip = was != 0 && polarity != was;
                const bool odd = (flip && flips > 0 && same < 200) || same > 300;
                flips += flip;
                same = flip ? 1 : same + 1;
                was = polarity;
                return in_motion(s) && odd;
              }};
}

}  // namespace

std::vector<FaultClass> drive_faults() {
  FaultClass residual =
      class_of(Hazard::ResidualCharge, {Mode::Ready, Mode::Active, Mode::Hold, Mode::Retract}, keep_charge);
  residual.row = 200;
  residual.fits = [](const ProcedureState& g) {
    return g.mode == Mode::Ready || std::abs(g.drive_mV) > 200'000;
  };

  FaultClass over = class_of(Hazard::OverVoltage, kDriven, run_away);
  over.row = 2;
  over.fits = [](const ProcedureState& g) { return g.left > 1; };  // a drive that is just off cannot run away
  over.raises_drive = true;

  FaultClass arcing = class_of(Hazard::Arc, {Mode::Active, Mode::Hold, Mode::Retract}, arc);
  arcing.row = 2;
  arcing.react_ms = 5;  // safety concept
  arcing.fits = under_voltage;

  FaultClass differs = class_of(Hazard::MonitorDisagrees, kDriven, disagree);
  differs.row = 3;
  differs.fits = [](const ProcedureState& g) { return g.mode == Mode::Armed || under_voltage(g); };
  differs.raises_drive = true;

  FaultClass disobeys = class_of(Hazard::DriverDisobeys, kReadyOrDriven, disobey);
  disobeys.row = 3;
  disobeys.fits = [](const ProcedureState& g) {
    return g.mode != Mode::Retract || std::abs(g.drive_mV) > 1'000'000;
  };
  disobeys.reaction = Reaction::OutputOff;
  disobeys.react_ms = disobeys.detect_ms + 21;  // the interlock's 20 ms after the last pulse
  disobeys.raises_drive = true;

  FaultClass locks = class_of(Hazard::DriverDisobeys, kDriven, lock_unasked);
  locks.id = "R-09/brake";
  locks.what = "driver locks the needle without a permit";
  locks.row = 3;

  FaultClass stuck = class_of(Hazard::PolarityStuck, {Mode::Active}, stick_polarity);
  stuck.fits = [](const ProcedureState& g) { return std::abs(g.drive_mV) > 1'200'000 && g.left > 1'900; };
  stuck.instead = bit(Hazard::WrongFrequency);  // where it sticks with a change of polarity

  FaultClass rate = class_of(Hazard::WrongFrequency, {Mode::Active}, change_rate);
  rate.fits = [](const ProcedureState& g) { return std::abs(g.drive_mV) > 1'200'000 && g.left > 1'700; };
  // A slow wave that has just begun is all of one sign; the charge it builds up moves the needle.
  rate.instead = bit(Hazard::PolarityStuck) | bit(Hazard::OffsetOrScale);
  return {residual, over, arcing, differs, disobeys, locks, stuck, rate};
}

}  // namespace biopsy::fault_injection
