#include "sim/plant/plant.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "sim/plant/circuit.hpp"
#include "sim/plant/mechanics.hpp"
#include "sim/plant/pouch.hpp"
#include "sim/plant/seeded_noise.hpp"
#include "sim/plant/sensor.hpp"

namespace biopsy::sim {
namespace {

constexpr double kStopped = 0.0;  // plate A at rest is exactly at rest
constexpr int kRootSteps = 6;
constexpr double kRootResolution = 1e-9;  // s
constexpr double kReach = 0.5e-3;         // m: further than any needle moves within a step
constexpr int kEventsPerStep = 4;  // stick or slip; more within one step means chatter below any resolution
constexpr int kMostCuts = 64;      // of one step where something is on its way that is faster than the step
constexpr double kRestInContact = 0.5e-6;         // m that plate A still rings against a stop
constexpr double kResolved = 5.0, kStable = 1.0;  // steps in the time in which contact rings by one radian
constexpr double kArrived = 1e-3;                 // share of the voltage that an amplifier may still be away

// m + h (a d + b e + c f): one row of the tableau, without touching what does not move.
Motion advanced(const StepContext& s, const Motion& m, double h, const Derivative& d, double a,
                const Derivative& e, double b, const Derivative& f, double c) {
  Motion out = m;
  out.H += h * (a * d.dH + b * e.dH + c * f.dH);
  out.x += h * (a * d.dx + b * e.dx + c * f.dx);
  out.v += h * (a * d.dv + b * e.dv + c * f.dv);
  if (s.has.inner) {
    out.pouch_crept += h * (a * d.dpouch + b * e.dpouch + c * f.dpouch);
    out.yielded += h * (a * d.dyielded + b * e.dyielded + c * f.dyielded);
    out.crept_lone += h * (a * d.dcrept_lone + b * e.dcrept_lone + c * f.dcrept_lone);
  }
  for (std::size_t i = 0; i < s.layers; ++i)
    out.crept[i] += h * (a * d.dcrept[i] + b * e.dcrept[i] + c * f.dcrept[i]);
  return out;
}

// Kutta's third-order method.
Motion runge_kutta(const StepContext& s, const Motion& m, double h, const VoltageProfile& volts,
                   int direction) {
  const Derivative a = rates(s, m, {volts.start, 0.0}, direction);
  const Derivative b = rates(s, advanced(s, m, h, a, 0.5, a, 0.0, a, 0.0), {volts.half, 0.5 * h}, direction);
  const Derivative c = rates(s, advanced(s, m, h, a, -1.0, b, 2.0, b, 0.0), {volts.end, h}, direction);
  return advanced(s, m, h, a, 1.0 / 6, b, 4.0 / 6, c, 1.0 / 6);
}

Potentials potentials(const PlantState& state) {
  return {state.u_i, state.u_o, state.memory.screened};
}

// Positive while plate A keeps doing what it does: force in reserve while stuck (N), speed while sliding
// (m/s).
double regime_margin(const StepContext& s, const Motion& m, Instant at, int direction) {
  if (direction != 0) return m.v * direction;
  return friction_bound(s.model, m.x, 0.0) - std::abs(net_force(s, m, at));
}

// +1, -1, or 0 where friction holds plate A.
int slide_direction(const StepContext& s, const Motion& m, bool breaks_away) {
  if (m.v != kStopped) return m.v > 0.0 ? 1 : -1;
  const double net = net_force(s, m, {acting_voltage(s.model, potentials(s.state)), 0.0});
  if (!breaks_away && std::abs(net) <= friction_bound(s.model, m.x, 0.0)) return 0;
  return net > 0.0 ? 1 : -1;
}

// The play's memory follows what pressure asks for now.
void remember_zipping(const PlantModel& model, PlantState& state) {
  const auto& play = model.effects.zipping_hysteresis;
  const Baseline& b = model.baseline;
  if (!play || b.drive == Drive::Force) return;
  const double top = on_top(model, state.motion, state.memory.largest);
  const double load = std::max(0.0, undamped_spring(model, state.motion, model.mass_A(), top)) + b.m_B * b.g;
  const double P = pressure(b, acting_voltage(model, potentials(state)));
  state.zipped = std::max(b.H_0, play->zipped(equilibrium(b, P, load).H, state.zipped));
}

// A substep of time in which plate A does one thing: its length, what the volts did, and the motion at its
// end.
struct Substep {
  double h;
  VoltageProfile volts;
  Motion after;
};

// Commits what a substep leaves behind.
void commit(const PlantModel& model, PlantState& state, const Substep& substep) {
  const Baseline& b = model.baseline;
  const Effects& e = model.effects;
  const double seen_before = e.sensor_lag ? sensed(model, state) : 0.0;
  const Potentials& volts = substep.volts.after;
  state.charge += b.C1 * ((volts.u_i - state.u_i) - (volts.u_o - state.u_o));
  state.u_i = volts.u_i;
  state.u_o = volts.u_o;
  state.memory.screened = volts.screened;
  state.motion = substep.after;
  state.time += substep.h;
  state.x_max = std::max(state.x_max, state.motion.x);
  if (e.hysteretic_spring) state.motion.yielded = e.hysteretic_spring->bounded(state.motion.yielded);
  if (const auto& set = e.residual_set)
    state.memory.largest =
        set->remembered(set->faded(state.memory.largest, substep.h), state.motion.H - b.H_0);
  if (e.backlash) state.memory.carried = e.backlash->carried(state.motion.x, state.memory.carried);
  remember_zipping(model, state);
  remember_reading(model, state, seen_before, substep.h);
}

Substep substep_of(const StepContext& s, Circuit& circuit, double h, int direction) {
  Substep substep{h, circuit.over(potentials(s.state), h), {}};
  substep.after = runge_kutta(s, s.state.motion, h, substep.volts, direction);
  return substep;
}

// The step, cut where the regime ends: found by false position (Illinois variant).
Substep until_event(const StepContext& s, Circuit& circuit, double h, int direction) {
  Substep substep = substep_of(s, circuit, h, direction);
  double at_high = regime_margin(s, substep.after, {substep.volts.end, h}, direction);
  if (at_high >= 0.0) return substep;
  double low = 0.0, high = h;
  double at_low = regime_margin(s, s.state.motion, {substep.volts.start, 0.0}, direction);
  for (int i = 0; i < kRootSteps && high - low > kRootResolution; ++i) {
    substep = substep_of(s, circuit, high - at_high * (high - low) / (at_high - at_low), direction);
    const double here = regime_margin(s, substep.after, {substep.volts.end, substep.h}, direction);
    if (here < 0.0) {
      high = substep.h, at_high = here, at_low *= 0.5;
    } else {
      low = substep.h, at_low = here, at_high *= 0.5;
    }
  }
  return substep;
}

std::size_t layers_within_reach(const PlantModel& model, const PlantState& state) {
  std::size_t layers = 0;
  while (layers < model.tissue.size() && model.tissue[layers].surface.depth < state.x_max + kReach) ++layers;
  return layers;
}

// One internal step of length h. With dry friction the step is cut where plate A stops or breaks away; the
// pieces keep the method's order, which a cut at the step's end would not.
void internal_step(const PlantModel& model, const Presence& has, PlantState& state, double h,
                   Circuit& circuit, const PlantInputs& inputs) {
  bool breaks_away = false;
  for (int event = 0; h > kRootResolution; ++event) {
    const StepContext s{model, inputs, state, has, layers_within_reach(model, state), model.mass_A()};
    const int direction = has.dry ? slide_direction(s, state.motion, breaks_away) : 1;
    const bool locate = has.dry && event < kEventsPerStep;
    Substep substep = locate ? until_event(s, circuit, h, direction) : substep_of(s, circuit, h, direction);
    if (has.dry && direction != 0 && (substep.h < h || substep.after.v * direction <= 0.0))
      substep.after.v = kStopped;
    breaks_away = direction == 0 && substep.h < h;
    commit(model, state, substep);
    h -= substep.h;
  }
}

// Into how many a step of h is to be cut because the amplifier is on its way or plate A about to hit the
// stop.
int cuts(const PlantModel& model, const PlantState& state, double h) {
  double rate = 0.0;  // 1/s
  const double missing = std::abs(state.memory.asked - state.u_i);
  const auto& lag = model.effects.amplifier_lag;
  if (lag && !lag->instant() &&
      missing > kArrived * std::max(std::abs(state.memory.asked), std::abs(state.u_i)))
    rate = 16.0 / (lag->time + missing * lag->slew);
  const Motion& m = state.motion;
  const auto& stop = model.effects.end_stop;
  if (stop && m.x + 2.0 * std::abs(m.v) * h > stop->position) {
    const double mass = model.mass_A();
    const double ringing = std::sqrt(stop->stiffness / mass) + stop->damping / mass;
    const bool at_rest_in_it = m.x > stop->position && std::abs(m.v) < kRestInContact * ringing;
    rate = std::max({rate, (at_rest_in_it ? 1.0 : 4.0) / h, (at_rest_in_it ? kStable : kResolved) * ringing});
  }
  return static_cast<int>(std::clamp(std::ceil(h * rate), 1.0, static_cast<double>(kMostCuts)));
}

// What is asked of the amplifier; one without lag jumps there, and the stack with it (eq. (2) at a sample).
void ask(const PlantModel& model, PlantState& state, double voltage) {
  const Effects& e = model.effects;
  const double asked = e.voltage_saturation ? e.voltage_saturation->limited(voltage) : voltage;
  state.memory.asked = asked;
  state.charge = 0.0;
  if (e.amplifier_lag && !e.amplifier_lag->instant()) return;
  const double jump = asked - state.u_i;
  state.u_i = asked;
  state.u_o += model.baseline.K * jump;
  state.charge = model.baseline.C1 * (1.0 - model.baseline.K) * jump;
}

}  // namespace

PlantState at_rest(const PlantModel& model) {
  PlantState state;
  state.motion.H = model.baseline.H_0;
  state.zipped = model.baseline.H_0;
  settle_reading(model, state, 0.0);
  return state;
}

void set_state(const PlantModel& model, PlantState& state, double x, double v) {
  const Baseline& b = model.baseline;
  const Effects& e = model.effects;
  Motion& m = state.motion;
  if (b.drive == Drive::Stack) {
    const double floor = b.H_0 + (e.residual_set ? e.residual_set->floor_share * state.memory.largest : 0.0);
    const double H = std::max(floor, m.H + (x - m.x) / b.n);
    state.zipped = std::max(b.H_0, state.zipped + (H - m.H));
    state.memory.largest = std::max(state.memory.largest, H - b.H_0);
    m.H = H;
  }
  m.x = x;
  m.v = v;
  state.x_max = std::max(state.x_max, x);
  if (e.backlash) state.memory.carried = v == 0.0 ? x : x - std::copysign(0.5 * e.backlash->gap, v);
  settle_reading(model, state, v);
}

PlantState step(const PlantModel& model, PlantState state, const PlantInputs& inputs, Seconds duration) {
  assert(model.tissue.size() <= kMaxLayers);
  ask(model, state, inputs.voltage);
  remember_zipping(model, state);  // a jump asks for most at once, before the load has risen
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration.count() / model.internal_step - 1e-9)));
  const double h = duration.count() / pieces;
  Circuit circuit(model, state.memory.asked, h);
  const Presence has = presence(model);
  const bool may_cut = model.effects.amplifier_lag || model.effects.end_stop;
  for (int i = 0; i < pieces; ++i) {
    const int parts = may_cut ? cuts(model, state, h) : 1;
    const double part = parts > 1 ? h / parts : h;
    for (int j = 0; j < parts; ++j) internal_step(model, has, state, part, circuit, inputs);
  }
  ++state.readings;
  return state;
}

double displacement_reading(const PlantModel& model, const PlantState& state) {
  const Effects& e = model.effects;
  double reading = e.sensor_lag ? state.reading - state.memory.delay.Dw : sensed(model, state);
  if (e.sensor_scale) reading *= 1.0 + e.sensor_scale->share;
  if (e.sensor_drift) reading += e.sensor_drift->walked(state.time);
  if (e.sensor_offset) reading += e.sensor_offset->offset;
  if (e.sensor_noise) reading += e.sensor_noise->std * normals(model.noise_seed, state.readings).first;
  return reading;
}

double plate_b(const PlantModel& model, const PlantState& state) {
  const double top = on_top(model, state.motion, state.memory.largest);
  return model.baseline.n * (state.motion.H - model.baseline.H_0 + top);
}

double current(const PlantModel& model, const PlantState& state) {
  const Baseline& b = model.baseline;
  const double rising = (1.0 - b.K) * amplifier_slope(model, state.u_i, state.memory.asked);
  return b.C1 * (state.u_o / b.tau + rising);
}

int layers_entered(const PlantModel& model, const PlantState& state) {
  int entered = 0;
  for (const TissueLayer& layer : model.tissue)
    if (layer.surface.force <= 0.0 ? state.x_max > layer.surface.depth : layer.surface.punctured(state.x_max))
      ++entered;
  return entered;
}

}  // namespace biopsy::sim
