// What breaks in the laser: stale, frozen, blind, off.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <limits>

#include "safety/types/limits.hpp"
#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {
namespace {

using safety::bit;
using safety::Hazard;

Corruptors stop_measuring(Draw&, Procedure& procedure, const TickRecord&) {
  return {.observation = [old = procedure.last().measurement](safety::SupervisorInputs& seen) {
    seen.measurement = old;
  }};
}

// Shown once the voltage moved by more than 200 V over the same code.
Corruptors freeze(Draw&, Procedure& procedure, const TickRecord&) {
  const Measurement old = procedure.last().measurement;
  return {
      .reading = [=](drivers::SensorReading& r) { r.depth_um = old.depth_um, r.laser_code = old.laser_code; },
      .shows =
          [low = std::numeric_limits<std::int32_t>::max(), high = 0](const ObservedTick& s) mutable {
            low = std::min(low, std::abs(s.seen.measurement.command_mV));
            high = std::max(high, std::abs(s.seen.measurement.command_mV));
            return high - low > 200'000;
          }};
}

Corruptors blind(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t instead_um = draw.whole(-20'000, 20'000);  // anything stands in the register
  const bool keeps = draw.coin();
  return {.reading =
              [=](drivers::SensorReading& r) {
                r.laser_valid = false;
                if (!keeps) r.depth_um = r.laser_code = instead_um;
              },
          .shows = [](const ObservedTick& s) { return !s.seen.measurement.laser_valid; }};
}

// Depths between which a sound stage lies at drives from low to high, by the plan's own table; um.
struct Range {
  double low, high;
};
double between(const std::vector<DepthBand>& bands, double drive_V, bool low) {
  const auto edge = [low](const DepthBand& band) { return 1e3 * (low ? band.low : band.high).value; };
  for (std::size_t i = 1; i < bands.size(); ++i) {
    if (drive_V > bands[i].drive.value) continue;
    const double part =
        (drive_V - bands[i - 1].drive.value) / (bands[i].drive.value - bands[i - 1].drive.value);
    return edge(bands[i - 1]) + part * (edge(bands[i]) - edge(bands[i - 1]));
  }
  return edge(bands.back());
}
Range plausible(const Plan& plan, double lowest_V, double highest_V) {
  return {between(plan.limits.plausible, lowest_V, true), between(plan.limits.plausible, highest_V, false)};
}

// The laser's zero walks off, at once or within half a second, to where no stage could be.
Corruptors run(Draw& draw, Procedure& procedure, const TickRecord& now) {
  const Plan& plan = procedure.scenario().plan;
  const double drive_V = std::abs(now.command_mV) * 1e-3;
  const Range sound = plausible(plan, drive_V, drive_V);
  const bool deeper = draw.coin();
  const double seen_um =
      deeper ? sound.high + draw.within(1'200.0, 4'000.0) : sound.low - draw.within(1'200.0, 4'000.0);
  const double offset_um = seen_um - 1e3 * now.depth_mm;
  const double ticks = draw.coin() ? 1.0 : draw.within(1.0, 300.0);
  return {.reading =
              [=, tick = 0.0](drivers::SensorReading& r) mutable {
                tick = std::min(ticks, tick + 1.0);
                r.depth_um += static_cast<std::int32_t>(offset_um * tick / ticks);
                r.laser_code = r.depth_um;
              },
          .shows =
              [&plan, past = std::deque<double>{}](const ObservedTick& s) mutable {
                past.push_back(1e-3 * std::abs(s.seen.measurement.command_mV));
                if (past.size() > 500) past.pop_front();
                const auto [low, high] = std::ranges::minmax_element(past);
                const Range range = plausible(plan, *low, *high);
                const double depth_um = s.seen.measurement.depth_um;
                return depth_um < range.low - 1'000.0 || depth_um > range.high + 1'000.0;
              }};
}

// The first laser alone departs: a jump with a drift, a wrong scale and a swing on it. (One that stands still
// shows nothing while the needle does, too: robot/procedure/campaign has it, and every other shape, in
// motion.)
Corruptors depart(Draw& draw, Procedure&, const TickRecord&) {
  const double jump_um = (draw.coin() ? 1.0 : -1.0) * draw.within(500.0, 3'000.0);
  const double drift_um = draw.within(-10.0, 10.0), swing_um = draw.within(0.0, 1'000.0);
  const double scale = draw.within(0.5, 1.5), turn = draw.within(0.001, 0.1);  // radians each tick
  return {.reading =
              [=, tick = 0.0](drivers::SensorReading& r) mutable {
                ++tick;
                const double error = jump_um + drift_um * tick + swing_um * std::sin(turn * tick);
                r.depth_um = static_cast<std::int32_t>(std::clamp(scale * r.depth_um + error, -1e6, 1e6));
                r.laser_code = r.depth_um;
              },
          .one_laser = true,
          .shows =
              [](const ObservedTick& s) {
                return std::abs(s.seen.measurement.depth_um - s.seen.measurement.depth_b_um) > 300;
              }};
}

// The first laser shows the needle and another place by turns, more often the other place.
Corruptors alternate(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t apart_um = static_cast<std::int32_t>(draw.either_sign(500.0, 3'000.0));
  const std::int32_t on = draw.whole(2, 9), off = draw.whole(1, on);
  return {.reading =
              [=, tick = 0](drivers::SensorReading& r) mutable {
                if (tick++ % (on + off) < on) r.depth_um += apart_um;
                r.laser_code = r.depth_um;
              },
          .one_laser = true,
          .shows =
              [](const ObservedTick& s) {
                return std::abs(s.seen.measurement.depth_um - s.seen.measurement.depth_b_um) > 300;
              }};
}

}  // namespace

std::vector<FaultClass> sensor_faults() {
  FaultClass stale = class_of(Hazard::SensorStale, kReadyOrDriven, stop_measuring);

  FaultClass frozen = class_of(Hazard::SensorFrozen, {Mode::Active}, freeze);
  frozen.fits = [](const ProcedureState& g) { return g.left > 100; };

  FaultClass dropout = class_of(Hazard::LaserDropout, kReadyOrDriven, blind);
  dropout.row = 3;

  FaultClass offset = class_of(Hazard::OffsetOrScale, {Mode::Ready, Mode::Active, Mode::Hold}, run);
  offset.row = 50;
  // A jump is first a needle that moved: far beyond the plan, or back faster than any can fall.
  offset.instead =
      bit(Hazard::HardOverDepth) | bit(Hazard::OverDepth) | bit(Hazard::FastDrop) | bit(Hazard::PopThrough);

  FaultClass departs = offset;
  departs.id = "R-21/one-laser";
  departs.what = "one of two lasers departs";
  departs.inject = depart;
  departs.row = 10;

  FaultClass turns = departs;
  turns.id = "R-21/by-turns";
  turns.what = "one of two lasers shows another place by turns";
  turns.inject = alternate;
  turns.row = 1;
  return {stale, frozen, dropout, offset, departs, turns};
}

}  // namespace biopsy::fault_injection
