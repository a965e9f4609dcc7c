#include "sim/plant/batch.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace biopsy::sim {
namespace {

constexpr std::size_t kNoBlock = std::numeric_limits<std::size_t>::max();

// Effects that change nothing but a constant, or what is read of the motion.
bool fits_lane(const PlantModel& model, Seconds period) {
  bool fits = model.baseline.drive == Drive::Stack && model.tissue.empty() && model.terms.empty() &&
              std::ceil(period.count() / model.internal_step - 1e-9) <= 1.0;
  for_each_present(model.effects, [&]<class E>(const E&) {
    if constexpr (HasState<E>) fits = false;
    if constexpr (!std::same_as<E, CoulombFriction> && !std::same_as<E, AddedMass> &&
                  !std::same_as<E, SensorNoise> && !std::same_as<E, SensorOffset> &&
                  !std::same_as<E, SensorScale>)
      fits = false;
  });
  return fits;
}

}  // namespace

PlantBatch::PlantBatch(std::vector<PlantModel> models, Seconds period)
    : period_(period), models_(std::move(models)) {
  for (std::size_t i = 0; i < models_.size(); ++i) {
    steppers_.emplace_back(models_[i]);
    states_.push_back(at_rest(models_[i]));
    places_.push_back({kNoBlock, 0});
    if (!fits_lane(models_[i], period_)) continue;
    if (blocks_.empty() || blocks_.back().used == kLanes) blocks_.emplace_back();
    Block& block = blocks_.back();
    if (block.used == 0)
      for (std::size_t lane = 0; lane < kLanes; ++lane) put(i, block, lane);
    put(i, block, block.used);
    places_[i] = {blocks_.size() - 1, block.used};
    block.stages[block.used++] = i;
  }
}

void PlantBatch::put(std::size_t i, Block& block, std::size_t lane) {
  const PlantModel& model = models_[i];
  const Baseline& b = model.baseline;
  LaneConstants& c = block.constants;
  c.K[lane] = b.K, c.C1[lane] = b.C1;
  c.mass[lane] = model.mass_A();
  c.mass_g[lane] = c.mass[lane] * b.g;
  c.H_0[lane] = b.H_0, c.n[lane] = b.n, c.k[lane] = b.k, c.c_k[lane] = b.c_k, c.c_s[lane] = b.c_s;
  c.c_k_n[lane] = b.c_k * b.n;
  c.tau_h[lane] = b.tau_h;
  c.load_B[lane] = b.m_B * b.g;
  c.permittivity[lane] = b.eps_film * kVacuumPermittivity;
  c.film[lane] = 2.0 * b.d_film * b.d_film;
  c.L0[lane] = b.L0;
  c.a[lane] = std::numbers::pi * b.V0 / b.L0;
  c.a_H[lane] = (2.0 / std::numbers::pi) * c.a[lane];
  c.dry[lane] = model.effects.coulomb_friction ? 1.0 : 0.0;
  c.friction[lane] = model.effects.coulomb_friction ? model.effects.coulomb_friction->force : 0.0;
  c.half_decay[lane] = std::exp(-0.5 * period_.count() / b.tau);
  write(states_[i], block.states, lane);
}

void PlantBatch::write(const PlantState& state, LaneStates& lanes, std::size_t lane) const {
  lanes.H[lane] = state.motion.H, lanes.x[lane] = state.motion.x, lanes.v[lane] = state.motion.v;
  lanes.u_i[lane] = state.u_i, lanes.u_o[lane] = state.u_o, lanes.charge[lane] = state.charge;
  lanes.x_max[lane] = state.x_max, lanes.time[lane] = state.time;
}

PlantState PlantBatch::state(std::size_t i) const {
  PlantState state = states_[i];
  if (!in_lane(i)) return state;
  const LaneStates& lanes = blocks_[places_[i].block].states;
  const std::size_t lane = places_[i].lane;
  state.motion.H = lanes.H[lane], state.motion.x = lanes.x[lane], state.motion.v = lanes.v[lane];
  state.u_command = state.u_i = lanes.u_i[lane], state.u_o = lanes.u_o[lane], state.charge = lanes.charge[lane];
  state.x_max = lanes.x_max[lane], state.time = lanes.time[lane];
  state.readings = steps_;
  return state;
}

void PlantBatch::step_block(Block& block) {
  LaneStates after;
  PerLane event;
  advance_lanes(block.constants, block.states, block.inputs, period_.count(), after, event);
  for (std::size_t lane = 0; lane < block.used; ++lane) {
    if (event[lane] == 0.0) continue;
    const std::size_t i = block.stages[lane];
    PlantState one = state(i);
    steppers_[i].advance(
        models_[i], one,
        {.voltage = block.inputs.voltage[lane], .external_force = block.inputs.external_force[lane]}, period_);
    write(one, after, lane);
  }
  block.states = after;
}

void PlantBatch::step(std::span<const double> voltage, std::span<const double> external_force) {
  assert(voltage.size() == size() && (external_force.empty() || external_force.size() == size()));
  for (Block& block : blocks_) {
    for (std::size_t lane = 0; lane < block.used; ++lane) {
      block.inputs.voltage[lane] = voltage[block.stages[lane]];
      if (!external_force.empty()) block.inputs.external_force[lane] = external_force[block.stages[lane]];
    }
    step_block(block);
  }
  for (std::size_t i = 0; i < size(); ++i)
    if (!in_lane(i))
      steppers_[i].advance(
          models_[i], states_[i],
          {.voltage = voltage[i], .external_force = external_force.empty() ? 0.0 : external_force[i]}, period_);
  ++steps_;
}

}  // namespace biopsy::sim
