#include "sim/plant.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "sim/pouch.hpp"
#include "sim/seeded_noise.hpp"

namespace biopsy::sim {
namespace {

constexpr double kStopped = 0.0;  // plate A at rest is exactly at rest
constexpr int kRootSteps = 6;
constexpr double kRootResolution = 1e-9;  // s
constexpr double kReach = 0.5e-3;         // m: further than any needle moves within a step
constexpr int kEventsPerStep = 8;  // stick or slip; more within one step means chatter below any resolution

// Everything one evaluation of the mechanics needs besides the motion itself.
struct Surroundings {
  const PlantModel& model;
  const PlantInputs& inputs;
  std::size_t layers;  // of tissue that the needle can touch within this step
  double zipped;       // height memory at the beginning of the step
  double x_max;
  double u_start;  // V, stack voltage at the beginning of the step
};

struct Derivative {
  double dH = 0.0, dx = 0.0, dv = 0.0, dcrept_lone = 0.0;
  std::array<double, kMaxLayers> dcrept;  // only for the layers within reach
};

// Force of the tissue against the needle except dry friction. N, down
double tissue_force(const Surroundings& s, const Motion& m) {
  double force = 0.0;
  for (std::size_t i = 0; i < s.layers; ++i) {
    const TissueLayer& layer = s.model.tissue[i];
    force += layer.surface.push_back(m.x, s.x_max) + layer.shaft.viscous * layer.shaft.inserted(m.x) * m.v +
             layer.relaxation.push_back(m.x, m.crept[i]);
  }
  const Effects& e = s.model.effects;
  if (e.layer_puncture) force += e.layer_puncture->push_back(m.x, s.x_max);
  if (e.shaft_friction) force += e.shaft_friction->viscous * e.shaft_friction->inserted(m.x) * m.v;
  if (e.tissue_relaxation) force += e.tissue_relaxation->push_back(m.x, m.crept_lone);
  return force;
}

void creep_rates(const Surroundings& s, const Motion& m, Derivative& d) {
  for (std::size_t i = 0; i < s.layers; ++i) d.dcrept[i] = s.model.tissue[i].relaxation.rate(m.x, m.crept[i]);
  if (const auto& lone = s.model.effects.tissue_relaxation) d.dcrept_lone = lone->rate(m.x, m.crept_lone);
}

// Dry friction available at this position and speed. N
double friction_bound(const PlantModel& model, double x, double v) {
  const Effects& e = model.effects;
  double bound = 0.0;
  if (e.coulomb_friction) bound += e.coulomb_friction->force;
  if (e.stribeck_friction) bound += e.stribeck_friction->magnitude(v);
  if (e.shaft_friction) bound += e.shaft_friction->coulomb * e.shaft_friction->inserted(x);
  for (const TissueLayer& layer : model.tissue) bound += layer.shaft.coulomb * layer.shaft.inserted(x);
  return bound;
}

// The spring's push without the part of its damper that depends on plate B's speed. N
double undamped_spring(const PlantModel& model, const Motion& m) {
  const Baseline& b = model.baseline;
  return model.mass_A() * b.g + b.k * (b.n * (m.H - b.H_0) - m.x) - b.c_k * m.v;
}

// Upward force of the series spring; sets the pouches' rate. The damper c_k makes the load depend on the
// speed of plate B and that speed on the load: one Newton step from the undamped load solves it, the coupling
// being a few %.
double spring_force(const Surroundings& s, const Motion& m, double u_o, double& dH) {
  const Baseline& b = s.model.baseline;
  const double undamped = undamped_spring(s.model, m);
  const double F0 = std::max(0.0, undamped);
  Equilibrium goal = equilibrium(b, pressure(b, u_o), F0 + b.m_B * b.g);
  if (const auto& play = s.model.effects.zipping_hysteresis) {
    const double zipped = std::max(b.H_0, play->zipped(goal.H, s.zipped));
    if (zipped == s.zipped || zipped == b.H_0) goal.slope = 0.0;  // inside the play the load has no say
    goal.H = zipped;
  }
  const double slope = undamped > 0.0 ? goal.slope : 0.0;
  dH = (goal.H - m.H) / (b.tau_h - slope * b.c_k * b.n);
  return std::max(0.0, undamped + b.c_k * b.n * dH);
}

// Net force on plate A without dry friction. N, up
double net_force(const Surroundings& s, const Motion& m, double u_o, double& dH) {
  const Baseline& b = s.model.baseline;
  const double down = b.c_s * m.v + s.inputs.external_force + tissue_force(s, m);
  if (b.drive == Drive::Force) return s.inputs.force - b.k * m.x - down;
  return spring_force(s, m, u_o, dH) - s.model.mass_A() * b.g - down;
}

// direction: +1 or -1 while sliding (friction opposes it), 0 while stuck.
Derivative rates(const Surroundings& s, const Motion& m, double u_o, int direction) {
  Derivative d;
  creep_rates(s, m, d);
  if (direction == 0) {
    if (s.model.baseline.drive == Drive::Stack) spring_force(s, m, u_o, d.dH);
    return d;
  }
  d.dx = m.v;
  d.dv = (net_force(s, m, u_o, d.dH) - direction * friction_bound(s.model, m.x, m.v)) / s.model.mass_A();
  return d;
}

// m + h (a d + b e + c f): one row of the tableau, without touching layers out of reach.
Motion advanced(const Motion& m, std::size_t layers, double h, const Derivative& d, double a,
                const Derivative& e, double b, const Derivative& f, double c) {
  Motion out = m;
  out.H += h * (a * d.dH + b * e.dH + c * f.dH);
  out.x += h * (a * d.dx + b * e.dx + c * f.dx);
  out.v += h * (a * d.dv + b * e.dv + c * f.dv);
  out.crept_lone += h * (a * d.dcrept_lone + b * e.dcrept_lone + c * f.dcrept_lone);
  for (std::size_t i = 0; i < layers; ++i)
    out.crept[i] += h * (a * d.dcrept[i] + b * e.dcrept[i] + c * f.dcrept[i]);
  return out;
}

// Kutta's third-order method. `decay`: what is left of the stack voltage after half of h.
Motion runge_kutta(const Surroundings& s, const Motion& m, double h, double decay, int direction) {
  const double u_half = s.u_start * decay, u_end = u_half * decay;
  const std::size_t n = s.layers;
  const Derivative a = rates(s, m, s.u_start, direction);
  const Derivative b = rates(s, advanced(m, n, h, a, 0.5, a, 0.0, a, 0.0), u_half, direction);
  const Derivative c = rates(s, advanced(m, n, h, a, -1.0, b, 2.0, b, 0.0), u_end, direction);
  return advanced(m, n, h, a, 1.0 / 6, b, 4.0 / 6, c, 1.0 / 6);
}

double half_decay(const PlantModel& model, double h) {
  return std::exp(-0.5 * h / model.baseline.tau);
}

// Positive while plate A keeps doing what it does: force in reserve while stuck (N), speed while sliding
// (m/s).
double regime_margin(const Surroundings& s, const Motion& m, double u_o, int direction) {
  if (direction != 0) return m.v * direction;
  double unused = 0.0;
  return friction_bound(s.model, m.x, 0.0) - std::abs(net_force(s, m, u_o, unused));
}

bool has_dry_friction(const PlantModel& model) {
  const Effects& e = model.effects;
  return e.coulomb_friction || e.stribeck_friction || e.shaft_friction || !model.tissue.empty();
}

// +1, -1, or 0 where friction holds plate A.
int slide_direction(const Surroundings& s, const Motion& m, bool breaks_away) {
  if (m.v != kStopped) return m.v > 0.0 ? 1 : -1;
  double unused = 0.0;
  const double net = net_force(s, m, s.u_start, unused);
  if (!breaks_away && std::abs(net) <= friction_bound(s.model, m.x, 0.0)) return 0;
  return net > 0.0 ? 1 : -1;
}

// The play's memory follows what pressure asks for now.
void remember_zipping(const PlantModel& model, PlantState& state) {
  const auto& play = model.effects.zipping_hysteresis;
  const Baseline& b = model.baseline;
  if (!play || b.drive == Drive::Force) return;
  const double load = std::max(0.0, undamped_spring(model, state.motion)) + b.m_B * b.g;
  state.zipped = std::max(b.H_0, play->zipped(equilibrium(b, pressure(b, state.u_o), load).H, state.zipped));
}

// Commits what the step leaves behind: voltage decayed, deepest position, zipped height.
void remember(const PlantModel& model, PlantState& state, const Motion& after, double h, double decay) {
  const Baseline& b = model.baseline;
  const double u_before = state.u_o;
  state.u_o *= decay * decay;
  state.charge += b.C1 * (u_before - state.u_o);
  state.motion = after;
  state.x_max = std::max(state.x_max, after.x);
  remember_zipping(model, state);
  if (const auto& lag = model.effects.sensor_lag)
    state.reading += (after.x - state.reading) * -std::expm1(-h / lag->time);
}

// How far a step of one regime got: its length, the motion there, and the voltage's decay over half of it.
struct Piece {
  double h;
  double decay;
  Motion after;
};

// The step, cut where the regime ends: found by false position (Illinois variant).
Piece until_event(const Surroundings& s, const Motion& start, double h, double decay, int direction) {
  Piece piece{h, decay, runge_kutta(s, start, h, decay, direction)};
  double at_high = regime_margin(s, piece.after, s.u_start * decay * decay, direction);
  if (at_high >= 0.0) return piece;
  double low = 0.0, high = h, at_low = regime_margin(s, start, s.u_start, direction);
  for (int i = 0; i < kRootSteps && high - low > kRootResolution; ++i) {
    piece.h = high - at_high * (high - low) / (at_high - at_low);
    piece.decay = half_decay(s.model, piece.h);
    piece.after = runge_kutta(s, start, piece.h, piece.decay, direction);
    const double here = regime_margin(s, piece.after, s.u_start * piece.decay * piece.decay, direction);
    if (here < 0.0) {
      high = piece.h, at_high = here, at_low *= 0.5;
    } else {
      low = piece.h, at_low = here, at_high *= 0.5;
    }
  }
  return piece;
}

std::size_t layers_within_reach(const PlantModel& model, const PlantState& state) {
  std::size_t layers = 0;
  while (layers < model.tissue.size() && model.tissue[layers].surface.depth < state.x_max + kReach) ++layers;
  return layers;
}

// One internal step of length h. With dry friction the step is cut where plate A stops or breaks away; the
// pieces keep the method's order, which a cut at the step's end would not.
void internal_step(const PlantModel& model, PlantState& state, double h, double decay,
                   const PlantInputs& inputs) {
  const bool dry = has_dry_friction(model);
  bool breaks_away = false;
  for (int event = 0; h > kRootResolution; ++event) {
    const Surroundings s{model,        inputs,      layers_within_reach(model, state),
                         state.zipped, state.x_max, state.u_o};
    const int direction = dry ? slide_direction(s, state.motion, breaks_away) : 1;
    const bool locate = dry && event < kEventsPerStep;
    Piece piece = locate ? until_event(s, state.motion, h, decay, direction)
                         : Piece{h, decay, runge_kutta(s, state.motion, h, decay, direction)};
    if (dry && direction != 0 && (piece.h < h || piece.after.v * direction <= 0.0)) piece.after.v = kStopped;
    breaks_away = direction == 0 && piece.h < h;
    remember(model, state, piece.after, piece.h, piece.decay);
    h -= piece.h;
    if (h > kRootResolution) decay = half_decay(model, h);
  }
}

}  // namespace

PlantState at_rest(const PlantModel& model) {
  PlantState state;
  state.motion.H = model.baseline.H_0;
  state.zipped = model.baseline.H_0;
  return state;
}

PlantState step(const PlantModel& model, PlantState state, const PlantInputs& inputs, Seconds duration) {
  assert(model.tissue.size() <= kMaxLayers);
  const Baseline& b = model.baseline;
  const double jump = inputs.voltage - state.u_i;
  state.u_i = inputs.voltage;
  state.u_o += b.K * jump;
  state.charge = b.C1 * (1.0 - b.K) * jump;
  remember_zipping(model, state);  // the jump asks for most at once, before the load has risen
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration.count() / model.internal_step - 1e-9)));
  const double h = duration.count() / pieces;
  const double decay = half_decay(model, h);
  for (int i = 0; i < pieces; ++i) internal_step(model, state, h, decay, inputs);
  ++state.readings;
  return state;
}

double displacement_reading(const PlantModel& model, const PlantState& state) {
  const Effects& e = model.effects;
  double reading = e.sensor_lag ? state.reading : state.motion.x;
  if (e.sensor_offset) reading += e.sensor_offset->offset;
  if (e.sensor_noise) reading += e.sensor_noise->std * normals(model.noise_seed, state.readings).first;
  return reading;
}

double plate_b(const PlantModel& model, const PlantState& state) {
  return model.baseline.n * (state.motion.H - model.baseline.H_0);
}

double current(const PlantModel& model, const PlantState& state) {
  return model.baseline.C1 * state.u_o / model.baseline.tau;
}

int layers_entered(const PlantModel& model, const PlantState& state) {
  int entered = 0;
  for (const TissueLayer& layer : model.tissue)
    if (layer.surface.force <= 0.0 ? state.x_max > layer.surface.depth : layer.surface.punctured(state.x_max))
      ++entered;
  return entered;
}

}  // namespace biopsy::sim
