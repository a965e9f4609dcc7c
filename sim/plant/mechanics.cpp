#include "sim/plant/mechanics.hpp"

#include <algorithm>
#include <cmath>

#include "sim/plant/circuit.hpp"
#include "sim/plant/pouch.hpp"

namespace biopsy::sim {
namespace {

PlateMotion plate_motion(const StepContext& s, const Motion& m, double v, Instant at) {
  return {m.x, v, s.state.x_max, s.state.time + at.since, s.model.baseline.drive == Drive::Stack};
}

// `load` plus that of the effects on plate A: of those of the tissue, or of the others. N, down
template <bool kTissue>
double with_effects(double load, const StepContext& s, const Motion& m, const PlateMotion& plate) {
  for_each_present(s.model.effects, m.integrated, s.state.remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::load; })
                       if constexpr ((E::info.attaches == Attachment::Tissue) == kTissue)
                         load += effect.load(plate, own...);
                   });
  return load;
}

// Of the model's tissue and the tissue effects, except dry friction. N, down
double tissue_load(const StepContext& s, const Motion& m, const PlateMotion& plate) {
  double load = 0.0;
  for (std::size_t i = 0; i < s.layers; ++i) {
    const TissueLayer& layer = s.model.tissue[i];
    load += layer.surface.load(plate) + layer.shaft.load(plate) + layer.relaxation.load(plate, m.crept[i]);
  }
  return s.has.tissue_load ? with_effects<true>(load, s, m, plate) : load;
}

// Rates of the states that are integrated; d.dH and the speed v (m/s) of plate A are known.
void state_rates(const StepContext& s, const Motion& m, double v, Derivative& d) {
  for (std::size_t i = 0; i < s.layers; ++i) d.dcrept[i] = s.model.tissue[i].relaxation.rate(m.x, m.crept[i]);
  if (s.has.term_memory)
    for (std::size_t i = 0; i < s.model.terms.size(); ++i) {
      const double time = s.model.terms[i].memory_time;
      d.dfaded[i] = time > 0.0 ? v - m.faded[i] / time : 0.0;
    }
  if (!s.has.integrated_state) return;
  const Baseline& b = s.model.baseline;
  const Flow flow{m.H - b.H_0, m.x, v, b.n, d.dH};
  d.integrated = {};
  for_each_effect(s.model.effects, [&]<class E>(const std::optional<E>& effect) {
    if constexpr (HasIntegratedState<E>)
      if (effect)
        state_in<E>(d.integrated, s.state.remembered) =
            effect->state_rate(flow, state_in<E>(m.integrated, s.state.remembered));
  });
}

// Upward force of the series spring; sets the pouches' rate. The damper c_k makes the load depend on the
// speed of plate B and that speed on the load: one Newton step from the undamped load solves it, the coupling
// being a few %. A stack without effects on top of its pouches is spared their sums.
template <bool kOffset>
double spring_force(const StepContext& s, const Motion& m, Instant at, double& dH) {
  const Baseline& b = s.model.baseline;
  PouchOffset offset;
  if constexpr (kOffset) offset = pouch_offset(s.model, m, s.state.remembered, at.since);
  double undamped = undamped_spring(s.model, s.has, m, s.state.remembered, s.mass, offset.height);
  if constexpr (kOffset) undamped += b.c_k * b.n * offset.rate;
  // The charge on the stack stays where its capacitance changes within the substep.
  double u = at.u;
  if (s.has.capacitance) u *= capacitance_ratio(s.model, s.state.motion.H) / capacitance_ratio(s.model, m.H);
  if (s.has.pulling) u = pulling_voltage(s.model, m, s.state.remembered, u);
  Equilibrium goal = equilibrium(b, pressure(b, u), std::max(0.0, undamped) + b.m_B * b.g);
  if (s.has.held)
    for_each_present(s.model.effects, m.integrated, s.state.remembered,
                     [&]<class E>(const E& effect, const auto&... own) {
                       if constexpr (requires { &E::held; }) goal = effect.held(goal, b.H_0, own...);
                     });
  if (kOffset && goal.H < offset.floor) goal = {offset.floor, 0.0};
  const double slope = undamped > 0.0 ? goal.slope : 0.0;
  const double per_H = kOffset ? b.n * (1.0 + offset.per_H) : b.n;  // plate B's travel per height of a pouch
  const double time = s.has.oil_time ? oil_time(s.model, goal.H - m.H) : b.tau_h;
  dH = (goal.H - m.H) / (time - slope * b.c_k * per_H);
  return std::max(0.0, undamped + b.c_k * per_H * dH);
}

double spring_force(const StepContext& s, const Motion& m, Instant at, double& dH) {
  return s.has.pouch_offset ? spring_force<true>(s, m, at, dH) : spring_force<false>(s, m, at, dH);
}

// Of the effects that change the spring, where a force drives and the spring is on the frame. N, up
double frame_spring_push(const StepContext& s, const Motion& m) {
  double push = 0.0;
  for_each_present(s.model.effects, m.integrated, s.state.remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::spring_push; })
                       push += effect.spring_push({-m.x, false}, own...);
                   });
  return push;
}

// Of the series spring, or the driving force. N, up
double drive_push(const StepContext& s, const Motion& m, Instant at) {
  double dH = 0.0;
  return s.model.baseline.drive == Drive::Stack ? spring_force(s, m, at, dH) : s.inputs.force;
}

// What the model's i-th term is a function of.
TermPoint term_point(const StepContext& s, const Motion& m, Instant at, std::size_t i) {
  const bool stack = s.model.baseline.drive == Drive::Stack;
  return {.x = m.x, .v = m.v, .drive = stack ? at.u : s.inputs.force, .memory = m.faded[i]};
}

// Of the terms, without dry friction. N, up
double term_force(const StepContext& s, const Motion& m, Instant at) {
  double force = 0.0;
  for (std::size_t i = 0; i < s.model.terms.size(); ++i)
    force += s.model.terms[i].force(term_point(s, m, at, i));
  return force;
}

double net_force(const StepContext& s, const Motion& m, Instant at, double& dH) {
  const Baseline& b = s.model.baseline;
  const bool stack = b.drive == Drive::Stack;
  const PlateMotion plate = plate_motion(s, m, m.v, at);
  double down = b.c_s * m.v + s.inputs.external_force + tissue_load(s, m, plate);
  if (s.inputs.grip.stiffness > 0.0) down += s.inputs.grip.load(m.x, m.v);
  if (s.has.load) {
    double load = with_effects<false>(0.0, s, m, plate);
    if (!stack) load -= frame_spring_push(s, m);
    down += load;
  }
  if (s.has.term) down -= term_force(s, m, at);
  if (!stack) return s.inputs.force - b.k * m.x - down;
  return spring_force(s, m, at, dH) - s.mass * b.g - down;
}

// An effect without strength adds nothing.
template <class Effect>
bool acts(const Effect& effect) {
  return std::ranges::any_of(Effect::parameters(), [&](const auto& parameter) {
    return parameter.role == Role::Strength && effect.*parameter.member != 0.0;
  });
}

}  // namespace

ActiveTerms active_terms(const PlantModel& model) {
  ActiveTerms has{};
  has.dry_friction = !model.tissue.empty();
  for_each_present(model.effects, [&]<class E>([[maybe_unused]] const E& effect) {
    constexpr bool kOnPouch = requires {
      &E::pouch_offset;
    };
    const bool adds = !kOnPouch || acts(effect);
    if constexpr (requires { &E::rubs; })
      has.dry_friction |= effect.rubs();
    else if constexpr (requires { &E::dry_friction; })
      has.dry_friction = true;
    if constexpr (requires { &E::friction_under; }) has.dry_friction = has.friction_under_push = true;
    if constexpr (requires { &E::capacitance_ratio; }) has.capacitance = true;
    if constexpr (kOnPouch) has.pouch_offset |= adds;
    if constexpr (requires { &E::spring_push; }) has.load = has.spring_push = true;
    if constexpr (requires { &E::load; })
      (E::info.attaches == Attachment::Tissue ? has.tissue_load : has.load) = true;
    if constexpr (
        requires { &E::held; } || requires { &E::hold; })
      has.held = true;
    if constexpr (requires { &E::pulling; }) has.pulling = true;
    if constexpr (requires { &E::oil_time_ratio; }) has.oil_time = true;
    if constexpr (
        requires { &E::bounded; } || requires { &E::remember; })
      has.remembers |= adds;
    if constexpr (requires { &E::follow; }) has.sensor_filter = true;
    if constexpr (requires { &E::cut_rate; }) has.cut_rate = true;
    if constexpr (HasIntegratedState<E>) has.integrated_state = true;
  });
  has.term = !model.terms.empty();
  for (const Term& term : model.terms) {
    has.dry_friction |= term.has_dry_friction();
    has.term_memory |= term.memory_time > 0.0;
  }
  return has;
}

double friction_bound(const StepContext& s, const Motion& m, double v, Instant at) {
  const PlateMotion plate = plate_motion(s, m, v, at);
  const double push = s.has.friction_under_push ? drive_push(s, m, at) : 0.0;
  double bound = 0.0;
  for_each_present(s.model.effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::dry_friction; }) bound += effect.dry_friction(plate);
    if constexpr (requires { &E::friction_under; }) bound += effect.friction_under(push);
  });
  for (const TissueLayer& layer : s.model.tissue)
    bound += layer.surface.dry_friction(plate) + layer.shaft.dry_friction(plate);
  if (s.has.term)
    for (std::size_t i = 0; i < s.model.terms.size(); ++i)
      bound += s.model.terms[i].dry_friction(term_point(s, m, at, i));
  return bound;
}

PouchOffset pouch_offset(const PlantModel& model, const Motion& m, const RememberedStates& remembered,
                         double since) {
  const double H_0 = model.baseline.H_0;
  PouchOffset sum;
  for_each_present(model.effects, m.integrated, remembered,
                   [&]<class E>(const E& effect, const auto&... own) {
                     if constexpr (requires { &E::pouch_offset; }) {
                       const PouchOffset one = effect.pouch_offset({m.H - H_0, H_0, since}, own...);
                       sum.height += one.height;
                       sum.rate += one.rate;
                       sum.per_H += one.per_H;
                       sum.floor = std::max(sum.floor, one.floor);
                     }
                   });
  return sum;
}

Force net_force(const StepContext& s, const Motion& m, Instant at) {
  Force force;
  force.net = net_force(s, m, at, force.dH);
  return force;
}

Derivative stuck_rates(const StepContext& s, const Motion& m, double dH) {
  Derivative d;
  d.dH = dH;
  if (s.evolves()) state_rates(s, m, 0.0, d);
  return d;
}

Derivative rates(const StepContext& s, const Motion& m, Instant at, int direction) {
  if (direction == 0) {
    double dH = 0.0;
    if (s.model.baseline.drive == Drive::Stack) spring_force(s, m, at, dH);
    return stuck_rates(s, m, dH);
  }
  Derivative d;
  d.dx = m.v;
  const double friction = s.has.dry_friction ? direction * friction_bound(s, m, m.v, at) : 0.0;
  d.dv = (net_force(s, m, at, d.dH) - friction) / s.mass;
  if (s.evolves()) state_rates(s, m, m.v, d);
  return d;
}

}  // namespace biopsy::sim
