// The library of effects. A new one is its own file, and here: its include, its place in `Effects`, and its
// place in the order in which effects act and are listed.
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <tuple>
#include <type_traits>

#include "sim/effects/electrical/amplifier_lag.hpp"
#include "sim/effects/electrical/charge_retention.hpp"
#include "sim/effects/electrical/polarity_asymmetry.hpp"
#include "sim/effects/electrical/voltage_power.hpp"
#include "sim/effects/electrical/voltage_saturation.hpp"
#include "sim/effects/electrical/voltage_threshold.hpp"
#include "sim/effects/electrical/zipping_capacitance.hpp"
#include "sim/effects/pouch/film_hysteresis.hpp"
#include "sim/effects/pouch/pouch_creep.hpp"
#include "sim/effects/pouch/residual_set.hpp"
#include "sim/effects/pouch/slow_unzipping.hpp"
#include "sim/effects/pouch/zipping_hysteresis.hpp"
#include "sim/effects/sensor/sensor_drift.hpp"
#include "sim/effects/sensor/sensor_lag.hpp"
#include "sim/effects/sensor/sensor_noise.hpp"
#include "sim/effects/sensor/sensor_offset.hpp"
#include "sim/effects/sensor/sensor_scale.hpp"
#include "sim/effects/stage/added_mass.hpp"
#include "sim/effects/stage/asymmetric_spring.hpp"
#include "sim/effects/stage/backlash.hpp"
#include "sim/effects/stage/coulomb_friction.hpp"
#include "sim/effects/stage/directional_damping.hpp"
#include "sim/effects/stage/end_stop.hpp"
#include "sim/effects/stage/external_force.hpp"
#include "sim/effects/stage/hardening_hysteresis.hpp"
#include "sim/effects/stage/hysteretic_spring.hpp"
#include "sim/effects/stage/load_dependent_friction.hpp"
#include "sim/effects/stage/lugre_friction.hpp"
#include "sim/effects/stage/periodic_disturbance.hpp"
#include "sim/effects/stage/piecewise_spring.hpp"
#include "sim/effects/stage/quadratic_damping.hpp"
#include "sim/effects/stage/spring_hardening.hpp"
#include "sim/effects/stage/stribeck_friction.hpp"
#include "sim/effects/tissue/layer_puncture.hpp"
#include "sim/effects/tissue/shaft_friction.hpp"
#include "sim/effects/tissue/tissue_relaxation.hpp"

namespace biopsy::sim {

struct Effects {
  std::optional<VoltageSaturation> voltage_saturation;
  std::optional<AmplifierLag> amplifier_lag;
  std::optional<ChargeRetention> charge_retention;
  std::optional<PolarityAsymmetry> polarity_asymmetry;
  std::optional<VoltageThreshold> voltage_threshold;
  std::optional<VoltagePower> voltage_power;
  std::optional<ZippingCapacitance> zipping_capacitance;
  std::optional<FilmHysteresis> film_hysteresis;
  std::optional<ZippingHysteresis> zipping_hysteresis;
  std::optional<ResidualSet> residual_set;
  std::optional<PouchCreep> pouch_creep;
  std::optional<SlowUnzipping> slow_unzipping;
  std::optional<AddedMass> added_mass;
  std::optional<SpringHardening> spring_hardening;
  std::optional<AsymmetricSpring> asymmetric_spring;
  std::optional<PiecewiseSpring> piecewise_spring;
  std::optional<HystereticSpring> hysteretic_spring;
  std::optional<HardeningHysteresis> hardening_hysteresis;
  std::optional<QuadraticDamping> quadratic_damping;
  std::optional<DirectionalDamping> directional_damping;
  std::optional<ExternalForce> external_force;
  std::optional<PeriodicDisturbance> periodic_disturbance;
  std::optional<EndStop> end_stop;
  std::optional<CoulombFriction> coulomb_friction;
  std::optional<StribeckFriction> stribeck_friction;
  std::optional<LugreFriction> lugre_friction;
  std::optional<LoadDependentFriction> load_dependent_friction;
  std::optional<LayerPuncture> layer_puncture;
  std::optional<ShaftFriction> shaft_friction;
  std::optional<TissueRelaxation> tissue_relaxation;
  std::optional<Backlash> backlash;
  std::optional<SensorLag> sensor_lag;
  std::optional<SensorScale> sensor_scale;
  std::optional<SensorDrift> sensor_drift;
  std::optional<SensorOffset> sensor_offset;
  std::optional<SensorNoise> sensor_noise;
};

inline constexpr std::tuple kEffectOrder{&Effects::voltage_saturation,
                                         &Effects::amplifier_lag,
                                         &Effects::charge_retention,
                                         &Effects::polarity_asymmetry,
                                         &Effects::voltage_threshold,
                                         &Effects::voltage_power,
                                         &Effects::zipping_capacitance,
                                         &Effects::film_hysteresis,
                                         &Effects::zipping_hysteresis,
                                         &Effects::residual_set,
                                         &Effects::pouch_creep,
                                         &Effects::slow_unzipping,
                                         &Effects::added_mass,
                                         &Effects::spring_hardening,
                                         &Effects::asymmetric_spring,
                                         &Effects::piecewise_spring,
                                         &Effects::hysteretic_spring,
                                         &Effects::hardening_hysteresis,
                                         &Effects::quadratic_damping,
                                         &Effects::directional_damping,
                                         &Effects::external_force,
                                         &Effects::periodic_disturbance,
                                         &Effects::end_stop,
                                         &Effects::coulomb_friction,
                                         &Effects::stribeck_friction,
                                         &Effects::lugre_friction,
                                         &Effects::load_dependent_friction,
                                         &Effects::layer_puncture,
                                         &Effects::shaft_friction,
                                         &Effects::tissue_relaxation,
                                         &Effects::backlash,
                                         &Effects::sensor_lag,
                                         &Effects::sensor_scale,
                                         &Effects::sensor_drift,
                                         &Effects::sensor_offset,
                                         &Effects::sensor_noise};

// Calls visit(optional effect) for each effect of the library.
template <class AnyEffects, class Visitor>
void for_each_effect(AnyEffects& effects, Visitor&& visit) {
  std::apply([&](auto... member) { (visit(effects.*member), ...); }, kEffectOrder);
}

template <class Effect>
concept HasState = requires {
  typename Effect::State;
};
template <class Effect>
concept HasIntegratedState = HasState<Effect> && std::same_as<typename Effect::State, double>;

namespace detail {

template <class... E>
consteval bool is_complete(std::tuple<std::optional<E> Effects::*...>) {
  return (sizeof(std::optional<E>) + ...) == sizeof(Effects);
}
template <class... E>
auto remembered(std::tuple<std::optional<E> Effects::*...>) {
  const auto state = []<class One>(std::type_identity<One>) {
    if constexpr (HasState<One> && !HasIntegratedState<One>)
      return std::tuple<typename One::State>{};
    else
      return std::tuple<>{};
  };
  return std::tuple_cat(state(std::type_identity<E>{})...);
}
// Number of integrated states before that of `Until`; of all with Until = void.
template <class Until, class... E>
consteval std::size_t integrated_before(std::tuple<std::optional<E> Effects::*...>) {
  std::size_t count = 0;
  bool counting = true;
  ((counting = counting && !std::same_as<E, Until>, count += counting && HasIntegratedState<E>), ...);
  return count;
}

}  // namespace detail

static_assert(detail::is_complete(kEffectOrder), "an effect of `Effects` is missing in kEffectOrder");

// States of the effects: those that are integrated with the motion, and the others by their type.
using IntegratedStates = std::array<double, detail::integrated_before<void>(kEffectOrder)>;
using RememberedStates = decltype(detail::remembered(kEffectOrder));

template <HasState Effect>
auto& state_in(auto& integrated, auto& remembered) {
  if constexpr (HasIntegratedState<Effect>)
    return integrated[detail::integrated_before<Effect>(kEffectOrder)];
  else
    return std::get<typename Effect::State>(remembered);
}

// Calls visit(effect) or visit(effect, its state) for each effect that is present.
template <class Visitor>
void for_each_present(const Effects& effects, auto& integrated, auto& remembered, Visitor&& visit) {
  for_each_effect(effects, [&]<class E>(const std::optional<E>& effect) {
    if (!effect) return;
    if constexpr (HasState<E>)
      visit(*effect, state_in<E>(integrated, remembered));
    else
      visit(*effect);
  });
}

// Calls visit(effect) for each effect that is present.
template <class Visitor>
void for_each_present(const Effects& effects, Visitor&& visit) {
  for_each_effect(effects, [&](const auto& effect) {
    if (effect) visit(*effect);
  });
}

}  // namespace biopsy::sim
