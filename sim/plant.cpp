#include "sim/plant.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "sim/pouch.hpp"
#include "sim/seeded_noise.hpp"

namespace biopsy::sim {
namespace {

constexpr double kStopped = 0.0;        // plate A at rest is exactly at rest
constexpr int kRootSteps = 6;
constexpr double kRootResolution = 1e-9;  // s
constexpr int kEventsPerStep = 8;       // stick or slip; more within one step means chatter below any resolution

// Everything one evaluation of the mechanics needs besides the motion itself.
struct Surroundings {
  const PlantModel& model;
  const PlantInputs& inputs;
  double zipped;   // height memory at the beginning of the step
  double x_max;
  double u_start;  // V, stack voltage at the beginning of the step
};

struct Derivative {
  double dH = 0.0, dx = 0.0, dv = 0.0;
  std::array<double, kMaxLayers + 1> dcrept{};
};

// Force of the tissue against the needle except dry friction, and the rates of its Maxwell elements. N, down
double tissue_force(const Surroundings& s, const Motion& m, Derivative& d) {
  double force = 0.0;
  std::size_t i = 0;
  for (const TissueLayer& layer : s.model.tissue) {
    force += layer.surface.push_back(m.x, s.x_max) + layer.shaft.viscous * layer.shaft.inserted(m.x) * m.v +
             layer.relaxation.push_back(m.x, m.crept[i]);
    d.dcrept[i] = layer.relaxation.rate(m.x, m.crept[i]);
    ++i;
  }
  const Effects& e = s.model.effects;
  if (e.layer_puncture) force += e.layer_puncture->push_back(m.x, s.x_max);
  if (e.shaft_friction) force += e.shaft_friction->viscous * e.shaft_friction->inserted(m.x) * m.v;
  if (e.tissue_relaxation) {
    force += e.tissue_relaxation->push_back(m.x, m.crept[kMaxLayers]);
    d.dcrept[kMaxLayers] = e.tissue_relaxation->rate(m.x, m.crept[kMaxLayers]);
  }
  return force;
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

// Upward force of the series spring; sets the pouches' rate. The damper c_k makes the load depend on the speed of
// plate B and that speed on the load: one Newton step from the undamped load solves it, the coupling being a few %.
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

// Net force on plate A without dry friction, and every rate but the speed's. N, up
double net_force(const Surroundings& s, const Motion& m, double u_o, Derivative& d) {
  const Baseline& b = s.model.baseline;
  d.dx = m.v;
  const double down = b.c_s * m.v + s.inputs.external_force + tissue_force(s, m, d);
  if (b.drive == Drive::Force) return s.inputs.force - b.k * m.x - down;
  return spring_force(s, m, u_o, d.dH) - s.model.mass_A() * b.g - down;
}

// direction: +1 or -1 while sliding (friction opposes it), 0 while stuck.
Derivative rates(const Surroundings& s, const Motion& m, double u_o, int direction) {
  Derivative d;
  const double force = net_force(s, m, u_o, d);
  if (direction == 0) {
    d.dx = 0.0;
    return d;
  }
  d.dv = (force - direction * friction_bound(s.model, m.x, m.v)) / s.model.mass_A();
  return d;
}

Motion advanced(const Motion& m, const Derivative& d, double h) {
  Motion out = m;
  out.H += h * d.dH;
  out.x += h * d.dx;
  out.v += h * d.dv;
  for (std::size_t i = 0; i < m.crept.size(); ++i) out.crept[i] += h * d.dcrept[i];
  return out;
}

Motion runge_kutta(const Surroundings& s, const Motion& m, double h, int direction) {
  const double half = std::exp(-0.5 * h / s.model.baseline.tau);
  const double u_half = s.u_start * half, u_end = u_half * half;
  const Derivative a = rates(s, m, s.u_start, direction);
  const Derivative b = rates(s, advanced(m, a, 0.5 * h), u_half, direction);
  const Derivative c = rates(s, advanced(m, b, 0.5 * h), u_half, direction);
  const Derivative d = rates(s, advanced(m, c, h), u_end, direction);
  Motion out = advanced(advanced(advanced(m, a, h / 6), b, h / 3), c, h / 3);
  return advanced(out, d, h / 6);
}

// Positive while plate A keeps doing what it does: force in reserve while stuck (N), speed while sliding (m/s).
double regime_margin(const Surroundings& s, const Motion& m, double u_o, int direction) {
  if (direction != 0) return m.v * direction;
  Derivative unused;
  return friction_bound(s.model, m.x, 0.0) - std::abs(net_force(s, m, u_o, unused));
}

// +1, -1, or 0 where friction holds plate A.
int slide_direction(const Surroundings& s, const Motion& m, bool breaks_away) {
  if (m.v != kStopped) return m.v > 0.0 ? 1 : -1;
  Derivative unused;
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
void remember(const PlantModel& model, PlantState& state, const Motion& after, double h) {
  const Baseline& b = model.baseline;
  const double u_before = state.u_o;
  state.u_o *= std::exp(-h / b.tau);
  state.charge += b.C1 * (u_before - state.u_o);
  state.motion = after;
  state.x_max = std::max(state.x_max, after.x);
  remember_zipping(model, state);
  if (const auto& lag = model.effects.sensor_lag)
    state.reading += (after.x - state.reading) * -std::expm1(-h / lag->time);
}

// Where within h the regime ends, by false position (Illinois variant), and the motion there.
std::pair<double, Motion> until_event(const Surroundings& s, const Motion& start, double h, int direction) {
  Motion after = runge_kutta(s, start, h, direction);
  double high = h, at_high = regime_margin(s, after, s.u_start * std::exp(-h / s.model.baseline.tau), direction);
  if (at_high >= 0.0) return {h, after};
  double low = 0.0, at_low = regime_margin(s, start, s.u_start, direction);
  double piece = h;
  for (int i = 0; i < kRootSteps && high - low > kRootResolution; ++i) {
    piece = high - at_high * (high - low) / (at_high - at_low);
    after = runge_kutta(s, start, piece, direction);
    const double here = regime_margin(s, after, s.u_start * std::exp(-piece / s.model.baseline.tau), direction);
    if (here < 0.0) {
      high = piece, at_high = here, at_low *= 0.5;
    } else {
      low = piece, at_low = here, at_high *= 0.5;
    }
  }
  return {piece, after};
}

// One internal step of length h. With dry friction the step is cut where plate A stops or breaks away; the pieces keep
// the method's order, which a cut at the step's end would not.
void internal_step(const PlantModel& model, PlantState& state, double h, const PlantInputs& inputs, bool dry) {
  bool breaks_away = false;
  for (int event = 0; h > kRootResolution; ++event) {
    const Surroundings s{model, inputs, state.zipped, state.x_max, state.u_o};
    if (!dry) return remember(model, state, runge_kutta(s, state.motion, h, 1), h);
    const int direction = slide_direction(s, state.motion, breaks_away);
    auto [piece, after] = event < kEventsPerStep ? until_event(s, state.motion, h, direction)
                                                 : std::pair{h, runge_kutta(s, state.motion, h, direction)};
    if (direction != 0 && (piece < h || after.v * direction <= 0.0)) after.v = kStopped;
    breaks_away = direction == 0 && piece < h;
    remember(model, state, after, piece);
    h -= piece;
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
  const Effects& e = model.effects;
  const bool dry = e.coulomb_friction || e.stribeck_friction || e.shaft_friction || !model.tissue.empty();
  const int pieces = std::max(1, static_cast<int>(std::ceil(duration.count() / model.internal_step - 1e-9)));
  const double h = duration.count() / pieces;
  for (int i = 0; i < pieces; ++i) internal_step(model, state, h, inputs, dry);
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
    if (layer.surface.force <= 0.0 ? state.x_max > layer.surface.depth : layer.surface.punctured(state.x_max)) ++entered;
  return entered;
}

}  // namespace biopsy::sim
