// Faults of the needle: held, dragged, struck, in unplanned tissue, in a patient that moves.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "safety/types/limits.hpp"
#include "tests/verification/fault_injection/fault_class.hpp"

namespace biopsy::fault_injection {
namespace {

using safety::bit;
using safety::Hazard;

// A hand on plate A: goes from x to `end` at `speed` and stays, like a stiff damped spring. SI.
auto hand(double x, double end, double speed) {
  return [=](const sim::Motion& m) mutable {
    constexpr double kStiff = 3'000.0, kDamped = 22.0, kTick_s = 1e-3;
    const double stride = std::clamp(end - x, -speed * kTick_s, speed * kTick_s);
    x += stride;
    return kStiff * (m.x - x) + kDamped * (m.v - stride / kTick_s);
  };
}

// Tissue or a jammed guide keeps the needle in when the drive goes.
Corruptors hold_needle(Draw& draw, Procedure&, const TickRecord& now) {
  Corruptors corrupt;
  const double at = draw.within(1.5e-3, std::max(1.6e-3, 1e-3 * now.depth_mm));
  corrupt.push_N = hand(1e-3 * now.depth_mm, at, 5e-3);
  const std::int32_t way = draw.whole(0, 2);
  corrupt.world = [way](robot::OperatorInputs& world) {
    if (way == 0) world.estop_closed = false;
    if (way == 1) world.stop = StopCategory::C1Ramp;
    if (way == 2) world.finish = true;
  };
  corrupt.shows = [quiet = 0](const ObservedTick& s) mutable {  // 0 V is known after three quiet samples
    const Measurement& m = s.seen.measurement;
    const bool zero =
        std::abs(m.monitor_mV) <= limits::kZeroVolt_mV && std::abs(m.command_mV) <= limits::kZeroVolt_mV;
    quiet = zero ? quiet + 1 : 0;
    return quiet >= 3 && m.depth_um > limits::kReturned_um;
  };
  return corrupt;
}

Corruptors drag_to(Draw& draw, const TickRecord& now, double end_mm, double slow_mm_s, double fast_mm_s) {
  return {.push_N = hand(1e-3 * now.depth_mm, 1e-3 * end_mm, 1e-3 * draw.within(slow_mm_s, fast_mm_s))};
}

Corruptors drag_far_beyond(Draw& draw, Procedure& procedure, const TickRecord& now) {
  const std::int32_t limit_um = procedure.facts().depth_max_um;
  Corruptors corrupt = drag_to(draw, now, 1e-3 * limit_um + draw.within(1.15, 1.9), 5.0, 70.0);
  corrupt.shows = [=](const ObservedTick& s) {
    return s.seen.measurement.depth_um > limit_um + limits::kDepthMargin_um;
  };
  return corrupt;
}

Corruptors drag_beyond(Draw& draw, Procedure& procedure, const TickRecord& now) {
  const std::int32_t limit_um = procedure.facts().depth_max_um;
  Corruptors corrupt = drag_to(draw, now, 1e-3 * limit_um + draw.within(0.35, 0.8), 2.0, 60.0);
  corrupt.shows = [=](const ObservedTick& s) { return s.seen.measurement.depth_um > limit_um; };
  return corrupt;
}

Corruptors drag_beyond_step(Draw& draw, Procedure& procedure, const TickRecord& now) {
  const auto& stage = procedure.facts().steps[now.step];
  const double room_mm = 1e-3 * (procedure.facts().depth_max_um - stage.depth_max_um);
  Corruptors corrupt =
      drag_to(draw, now, 1e-3 * stage.depth_max_um + draw.within(0.25, std::min(0.45, room_mm)), 2.0, 40.0);
  corrupt.shows = [](const ObservedTick& s) {
    return s.seen.permit.mode == Mode::Active && s.seen.measurement.depth_um > s.seen.permit.depth_max_um;
  };
  return corrupt;
}

// Drive lost: a pushed needle falls as one without support, or faster.
Corruptors drop(Draw& draw, Procedure&, const TickRecord&) {
  const double push_N = draw.within(1.5, 5.0);
  return {.push_N = [=](const sim::Motion&) { return push_N; },
          .shows = [](const ObservedTick& s) { return s.truth.v < -0.050; }};
}

Corruptors jerk(Draw& draw, Procedure&, const TickRecord& now) {
  Corruptors corrupt;
  const double way_mm = draw.within(1.0, 1.7);
  corrupt.push_N =
      hand(1e-3 * now.depth_mm, 1e-3 * (now.depth_mm + way_mm), 1e-3 * draw.within(120.0, 300.0));
  corrupt.shows = [past = std::vector<std::int32_t>{}](const ObservedTick& s) mutable {
    past.push_back(s.seen.measurement.depth_um);
    const std::size_t ten = past.size() > 10 ? past.size() - 11 : 0;
    return past.back() - past[ten] > 800;
  };
  return corrupt;
}

// Tissue much stiffer than planned, building up within a second; or a model of it that is wrong.
Corruptors stiffen(Draw& draw, Procedure&, const TickRecord&) {
  Corruptors corrupt;
  if (draw.coin()) {
    const double most_N = draw.within(3.5, 6.0), rise_N = draw.within(1.0, 3.0) * 1e-3;
    corrupt.push_N = [=, force = 0.0](const sim::Motion&) mutable {
      return force = std::min(most_N, force + rise_N);
    };
  } else {
    const std::int32_t residual_um = draw.coin() ? draw.whole(501, 5'000) : -1;
    corrupt.observation = [=](safety::SupervisorInputs& seen) { seen.tissue_residual_um = residual_um; };
  }
  corrupt.shows = [](const ObservedTick& s) {
    return s.seen.tissue_residual_um > 500 || s.seen.tissue_residual_um < 0;
  };
  return corrupt;
}

Corruptors move_patient(Draw& draw, Procedure&, const TickRecord&) {
  const std::int32_t moved_um = draw.coin() ? draw.whole(2'001, 2'500) : draw.whole(2'500, 40'000);
  const std::int32_t seen_um = draw.within(0.0, 1.0) < 0.1 ? -1 : moved_um;  // negative: unknown
  return {.world = [=](robot::OperatorInputs& world) { world.patient_motion_um = seen_um; }};
}

bool deep(const ProcedureState& g) {
  return g.depth_um > 2'000;
}

}  // namespace

std::vector<FaultClass> needle_faults() {
  const safety::HazardSet beyond = bit(Hazard::HardOverDepth) | bit(Hazard::OverDepth);

  FaultClass held = class_of(Hazard::NeedleNotBack, kInserted, hold_needle);
  held.row = 500;
  held.fits = deep;
  held.moves_needle = true;

  FaultClass hard = class_of(Hazard::HardOverDepth, kInserted, drag_far_beyond);
  hard.row = 2;
  hard.fits = deep;
  hard.instead = bit(Hazard::OverDepth);  // a slow one is off before it is that deep
  hard.moves_needle = true;

  FaultClass over = class_of(Hazard::OverDepth, kInserted, drag_beyond);
  over.row = 2;
  over.fits = deep;
  over.instead = bit(Hazard::HardOverDepth) | bit(Hazard::PopThrough);
  over.moves_needle = true;

  FaultClass stage = class_of(Hazard::StepDepth, {Mode::Active}, drag_beyond_step);
  stage.row = 2;
  stage.fits = [](const ProcedureState& g) { return g.depth_um > 300 && g.left > 500; };  // the slowest drag
  // Dragged on slowly it is first unlike its tissue, or out at 0 V: the loop gives way.
  stage.instead =
      beyond | bit(Hazard::PopThrough) | bit(Hazard::SuspectTissueModel) | bit(Hazard::NeedleNotBack);
  stage.moves_needle = true;

  FaultClass fall = class_of(Hazard::FastDrop, kInserted, drop);
  fall.fits = deep;
  fall.moves_needle = true;

  FaultClass pop = class_of(Hazard::PopThrough, kInserted, jerk);
  pop.row = 2;
  pop.fits = [](const ProcedureState& g) { return g.depth_um > 500; };
  pop.instead = beyond;
  pop.moves_needle = true;

  FaultClass suspect = class_of(Hazard::SuspectTissueModel, kInserted, stiffen);
  suspect.row = 100;
  suspect.fits = deep;
  suspect.moves_needle = true;

  FaultClass wrong = class_of(Hazard::WrongTissueModel, kInserted, stiffen);
  wrong.row = 1'100;
  wrong.fits = deep;
  wrong.moves_needle = true;

  FaultClass patient =
      class_of(Hazard::PatientMotion, {Mode::Ready, Mode::Armed, Mode::Active, Mode::Hold}, move_patient);
  return {held, hard, over, stage, fall, pop, suspect, wrong, patient};
}

}  // namespace biopsy::fault_injection
