#include "sim/plant/plant.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "sim/plant/pouch.hpp"
#include "sim/plant/sensor.hpp"
#include "sim/plant/stepper.hpp"

namespace biopsy::sim {
namespace {

constexpr double kStopped = 0.0;  // plate A at rest is exactly at rest
constexpr int kRootSteps = 6;
constexpr double kRootResolution = 1e-9;  // s
constexpr double kReach = 0.5e-3;         // m: further than any needle moves within a step
constexpr int kEventsPerStep = 4;  // stick or slip; more within one step means chatter below any resolution
constexpr int kMostCuts = 64;      // of one step where something moves faster than the step resolves

// One row of the tableau: m + h (a d + b e + c f), for the states that evolve besides plate A and the
// pouches.
void advance_states(const StepContext& s, Motion& m, double h, const Derivative& d, double a,
                    const Derivative& e, double b, const Derivative& f, double c) {
  if (s.has.integrated_state)
    for (std::size_t i = 0; i < m.integrated.size(); ++i)
      m.integrated[i] += h * (a * d.integrated[i] + b * e.integrated[i] + c * f.integrated[i]);
  for (std::size_t i = 0; i < s.layers; ++i)
    m.crept[i] += h * (a * d.dcrept[i] + b * e.dcrept[i] + c * f.dcrept[i]);
  if (s.has.term_memory)
    for (std::size_t i = 0; i < s.model.terms.size(); ++i)
      m.faded[i] += h * (a * d.dfaded[i] + b * e.dfaded[i] + c * f.dfaded[i]);
}

// The same for the whole motion.
Motion advanced(const StepContext& s, const Motion& m, double h, const Derivative& d, double a,
                const Derivative& e, double b, const Derivative& f, double c) {
  Motion out = m;
  out.H += h * (a * d.dH + b * e.dH + c * f.dH);
  out.x += h * (a * d.dx + b * e.dx + c * f.dx);
  out.v += h * (a * d.dv + b * e.dv + c * f.dv);
  if (s.evolves()) advance_states(s, out, h, d, a, e, b, f, c);
  return out;
}

// How plate A moves over a substep; and the rate of the pouches at its beginning where it is stuck, m/s.
struct Regime {
  int direction;  // +1, -1, or 0 where friction holds plate A
  double dH = 0.0;
};

// Kutta's third-order method.
Motion runge_kutta(const StepContext& s, const Motion& m, double h, const VoltageProfile& volts,
                   const Regime& regime) {
  const int direction = regime.direction;
  const Derivative a =
      direction == 0 ? stuck_rates(s, m, regime.dH) : rates(s, m, {volts.start, 0.0}, direction);
  const Derivative b = rates(s, advanced(s, m, h, a, 0.5, a, 0.0, a, 0.0), {volts.half, 0.5 * h}, direction);
  const Derivative c = rates(s, advanced(s, m, h, a, -1.0, b, 2.0, b, 0.0), {volts.end, h}, direction);
  return advanced(s, m, h, a, 1.0 / 6, b, 4.0 / 6, c, 1.0 / 6);
}

CircuitState circuit_state(const PlantState& state) {
  return {state.u_i, state.u_o, state.screened};
}

// Positive while the regime lasts: friction in reserve while stuck (N), speed while sliding (m/s).
double regime_margin(const StepContext& s, const Motion& m, Instant at, int direction) {
  if (direction != 0) return m.v * direction;
  return friction_bound(s, m, 0.0, at) - std::abs(net_force(s, m, at).net);
}

Regime regime_of(const StepContext& s, const Motion& m, bool breaks_away) {
  if (m.v != kStopped) return {m.v > 0.0 ? 1 : -1};
  const Instant now{acting_voltage(s.model, circuit_state(s.state)), 0.0};
  const Force force = net_force(s, m, now);
  if (!breaks_away && std::abs(force.net) <= friction_bound(s, m, 0.0, now)) return {0, force.dH};
  return {force.net > 0.0 ? 1 : -1};
}

// States that follow the height at which pressure carries the load now.
void hold_pouches(const PlantModel& model, const ActiveTerms& has, double mass, PlantState& state) {
  const Baseline& b = model.baseline;
  if (!has.held || b.drive == Drive::Force) return;
  for_each_present(
      model.effects, state.motion.integrated, state.remembered, [&]<class E>(const E& effect, auto&... own) {
        if constexpr (requires { &E::hold; }) {
          const double offset =
              has.pouch_offset ? pouch_offset(model, state.motion, state.remembered, 0.0).height : 0.0;
          const double spring = undamped_spring(model, has, state.motion, state.remembered, mass, offset);
          const double u = acting_voltage(model, circuit_state(state));
          const double P = pressure(b, pulling_voltage(model, state.motion, state.remembered, u));
          effect.hold(equilibrium(b, P, std::max(0.0, spring) + b.m_B * b.g).H, b.H_0, own...);
        }
      });
}

// A substep of one regime, stuck or sliding: its length, the voltage over it, and the motion at its end.
struct Substep {
  double h;
  VoltageProfile volts;
  Motion after;
};

// Takes over the motion and voltages at the substep's end, and what effects remember of it.
void commit(const PlantModel& model, const ActiveTerms& has, double mass, PlantState& state,
            const Substep& substep) {
  const Baseline& b = model.baseline;
  const double target_before = has.sensor_filter ? target_position(model, state) : 0.0;
  CircuitState circuit = substep.volts.after;
  if (has.capacitance)  // the charge on the stack stays where its capacitance changes
    circuit.u_o *= capacitance_ratio(model, state.motion.H) / capacitance_ratio(model, substep.after.H);
  state.charge += b.C1 * ((circuit.u_i - state.u_i) - (circuit.u_o - state.u_o));
  state.u_i = circuit.u_i;
  state.u_o = circuit.u_o;
  state.screened = circuit.screened;
  state.motion = substep.after;
  state.time += substep.h;
  state.x_max = std::max(state.x_max, state.motion.x);
  const Moved moved{state.motion.H - b.H_0, state.motion.x, substep.h};
  if (has.remembers)
    for_each_present(model.effects, state.motion.integrated, state.remembered,
                     [&]<class E>(const E& effect, auto&... own) {
                       if constexpr (requires { &E::bounded; }) ((own = effect.bounded(own)), ...);
                       if constexpr (requires { &E::remember; }) effect.remember(moved, own...);
                     });
  hold_pouches(model, has, mass, state);
  if (has.sensor_filter) follow_target(model, state, target_before, substep.h);
}

Substep substep_of(const StepContext& s, Circuit& circuit, double h, const Regime& regime) {
  if (s.has.capacitance) circuit.set_capacitance(capacitance_ratio(s.model, s.state.motion.H));
  const VoltageProfile volts = circuit.over(s.model, circuit_state(s.state), h);
  return {h, volts, runge_kutta(s, s.state.motion, h, volts, regime)};
}

// The step, cut where the regime ends; located by false position (Illinois variant).
Substep until_event(const StepContext& s, Circuit& circuit, double h, const Regime& regime) {
  const int direction = regime.direction;
  Substep substep = substep_of(s, circuit, h, regime);
  double at_high = regime_margin(s, substep.after, {substep.volts.end, h}, direction);
  if (at_high >= 0.0) return substep;
  double low = 0.0, high = h;
  double at_low = regime_margin(s, s.state.motion, {substep.volts.start, 0.0}, direction);
  for (int i = 0; i < kRootSteps && high - low > kRootResolution; ++i) {
    substep = substep_of(s, circuit, high - at_high * (high - low) / (at_high - at_low), regime);
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

// One internal step of length h. With dry friction the step is cut where plate A stops or breaks away, which
// keeps the order of the method.
void internal_step(const PlantModel& model, const ActiveTerms& has, double mass, PlantState& state, double h,
                   Circuit& circuit, const PlantInputs& inputs) {
  bool breaks_away = false;
  for (int event = 0; h > kRootResolution; ++event) {
    const StepContext s{model, inputs, state, has, layers_within_reach(model, state), mass};
    const Regime regime = has.dry_friction ? regime_of(s, state.motion, breaks_away) : Regime{1};
    const int direction = regime.direction;
    const bool locate = has.dry_friction && event < kEventsPerStep;
    Substep substep = locate ? until_event(s, circuit, h, regime) : substep_of(s, circuit, h, regime);
    if (has.dry_friction && direction != 0 && (substep.h < h || substep.after.v * direction <= 0.0))
      substep.after.v = kStopped;
    breaks_away = direction == 0 && substep.h < h;
    commit(model, has, mass, state, substep);
    h -= substep.h;
  }
}

// Into how many a step of h is to be cut because of something faster.
int cuts(const PlantModel& model, const PlantState& state, double h) {
  const Motion& m = state.motion;
  double rate = 0.0;  // 1/s
  for_each_present(model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::cut_rate; })
      rate = std::max(rate, effect.cut_rate({state.u_command, state.u_i, m.x, m.v, model.mass_A(), h}));
  });
  return static_cast<int>(std::clamp(std::ceil(h * rate), 1.0, static_cast<double>(kMostCuts)));
}

// Commands the amplifier; one without lag jumps there, and the stack with it (eq. (2) at a sample).
void command(const PlantModel& model, bool instant, PlantState& state, double voltage) {
  state.u_command = commanded_voltage(model, voltage);
  state.charge = 0.0;
  if (!instant) return;
  const double jump = state.u_command - state.u_i;
  const double K = model.baseline.K / capacitance_ratio(model, state.motion.H);
  state.u_i = state.u_command;
  state.u_o += K * jump;
  state.charge = model.baseline.C1 * (1.0 - K) * jump;
}

// States of the effects as steady motion leaves them, the pouches having been changed by dH.
void settle(const PlantModel& model, PlantState& state, double dH) {
  const Motion& m = state.motion;
  const double H_0 = model.baseline.H_0;
  for_each_present(model.effects, state.motion.integrated, state.remembered,
                   [&]<class E>(const E& effect, auto&... own) {
                     if constexpr (requires { &E::settle; })
                       effect.settle({dH, m.H - H_0, H_0, m.x, m.v, target_position(model, state)}, own...);
                   });
}

}  // namespace

PlantState at_rest(const PlantModel& model) {
  PlantState state;
  state.motion.H = model.baseline.H_0;
  settle(model, state, 0.0);
  return state;
}

void set_state(const PlantModel& model, PlantState& state, double x, double v) {
  const Baseline& b = model.baseline;
  Motion& m = state.motion;
  double dH = 0.0;
  if (b.drive == Drive::Stack) {
    const double floor = std::max(b.H_0, pouch_offset(model, m, state.remembered, 0.0).floor);
    const double H = std::max(floor, m.H + (x - m.x) / b.n);
    dH = H - m.H;
    state.u_o *= capacitance_ratio(model, m.H) / capacitance_ratio(model, H);
    m.H = H;
  }
  m.x = x;
  m.v = v;
  m.faded.fill(0.0);
  state.x_max = std::max(state.x_max, x);
  settle(model, state, dH);
}

void shift(const PlantModel& model, PlantState& state, double dx) {
  state.motion.x += dx;
  state.x_max += dx;
  for_each_present(model.effects, state.motion.integrated, state.remembered,
                   [&]<class E>(const E& effect, auto&... own) {
                     if constexpr (requires { &E::shift; }) effect.shift(dx, own...);
                   });
}

Stepper::Stepper(const PlantModel& model)
    : has_(active_terms(model)), mass_(model.mass_A()), circuit_(model) {
  assert(model.tissue.size() <= kMaxLayers);
}

void Stepper::advance(const PlantModel& model, PlantState& state, const PlantInputs& inputs,
                      Seconds duration) {
  command(model, circuit_.instant(), state, inputs.voltage);
  circuit_.command(state.u_command);
  hold_pouches(model, has_, mass_,
               state);  // a jump carries the pouches furthest at once, before the load has risen
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration.count() / model.internal_step - 1e-9)));
  const double h = duration.count() / pieces;
  for (int i = 0; i < pieces; ++i) {
    const int parts = has_.cut_rate ? cuts(model, state, h) : 1;
    const double part = parts > 1 ? h / parts : h;
    for (int j = 0; j < parts; ++j) internal_step(model, has_, mass_, state, part, circuit_, inputs);
  }
  ++state.readings;
}

PlantState step(const PlantModel& model, PlantState state, const PlantInputs& inputs, Seconds duration) {
  Stepper(model).advance(model, state, inputs, duration);
  return state;
}

double displacement_reading(const PlantModel& model, const PlantState& state) {
  const ReadingMoment now{state.time, model.noise_seed, state.readings};
  double reading = target_position(model, state);
  for_each_present(model.effects, state.motion.integrated, state.remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::filtered; }) reading = effect.filtered(own...);
                     if constexpr (requires { &E::read; }) reading = effect.read(reading, now);
                   });
  return reading;
}

double plate_b(const PlantModel& model, const PlantState& state) {
  const double offset = pouch_offset(model, state.motion, state.remembered, 0.0).height;
  return model.baseline.n * (state.motion.H - model.baseline.H_0 + offset);
}

double current(const PlantModel& model, const PlantState& state) {
  const Baseline& b = model.baseline;
  const double ratio = capacitance_ratio(model, state.motion.H);
  const double rising =
      (1.0 - b.K / ratio) * amplifier_slope(amplifier_dynamics(model.effects), state.u_i, state.u_command);
  return b.C1 * (state.u_o / (b.tau * ratio) + rising);
}

int layers_entered(const PlantModel& model, const PlantState& state) {
  int entered = 0;
  for (const TissueLayer& layer : model.tissue)
    if (layer.surface.force <= 0.0 ? state.x_max > layer.surface.depth : layer.surface.punctured(state.x_max))
      ++entered;
  return entered;
}

}  // namespace biopsy::sim
