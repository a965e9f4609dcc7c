// The needle stage and what surrounds it, as constants: nothing here changes while it moves.
// Source: Xiong, Zhou, Li, Yeow, eq. (1)-(21); docs/explanation/model.md says where the paper is silent or
// misprinted. SI units.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/effects/added_mass.hpp"
#include "sim/effects/amplifier_lag.hpp"
#include "sim/effects/backlash.hpp"
#include "sim/effects/charge_retention.hpp"
#include "sim/effects/coulomb_friction.hpp"
#include "sim/effects/end_stop.hpp"
#include "sim/effects/external_force.hpp"
#include "sim/effects/hysteretic_spring.hpp"
#include "sim/effects/layer_puncture.hpp"
#include "sim/effects/periodic_disturbance.hpp"
#include "sim/effects/polarity_asymmetry.hpp"
#include "sim/effects/pouch_creep.hpp"
#include "sim/effects/quadratic_damping.hpp"
#include "sim/effects/residual_set.hpp"
#include "sim/effects/sensor_drift.hpp"
#include "sim/effects/sensor_lag.hpp"
#include "sim/effects/sensor_noise.hpp"
#include "sim/effects/sensor_offset.hpp"
#include "sim/effects/sensor_scale.hpp"
#include "sim/effects/shaft_friction.hpp"
#include "sim/effects/spring_hardening.hpp"
#include "sim/effects/stribeck_friction.hpp"
#include "sim/effects/tissue_relaxation.hpp"
#include "sim/effects/voltage_saturation.hpp"
#include "sim/effects/zipping_hysteresis.hpp"

namespace biopsy::sim {

inline constexpr double kVacuumPermittivity = 8.8541878128e-12;  // F/m, CODATA 2018

enum class Drive : std::uint8_t {
  Stack,  // voltage on the pouches
  Force,  // a measured force on plate A: mechanical data that never saw a HASEL
};

// Defaults are the reference values; sim/models/baseline.toml holds the same and a test compares them.
struct Baseline {
  Drive drive = Drive::Stack;
  double K = 0.80;              // C1/(C1+C2)
  double tau = 6.9;             // s, R (C1+C2)
  double eps_film = 3.4;        // relative permittivity of the films
  double d_film = 100e-6;       // m, both films of a zipped pouch
  double L0 = 0.060;            // m, width of a pouch
  double V0 = 1.9e-7;           // m^3, displaced volume (not the 3.2 mL filled in)
  double H_0 = 0.35e-3;         // m, height of a pouch at rest
  double n = 11;                // stacked pouches
  double tau_h = 0.030;         // s, oil flow
  double k = 140;               // N/m, series spring (the paper's 14 N/m is a slip of units)
  double c_k = 0.05;            // N s/m
  double c_s = 0.60;            // N s/m, slider
  double fixture_mass = 0.030;  // kg, plate A without the run's weight
  double m_B = 0.030;           // kg, plate B
  double m = 0.080;             // kg, moving mass of a force-driven stage
  double C1 = 2.0e-9;           // F
  double g = 9.81;              // m/s^2
};

struct Effects {
  std::optional<VoltageSaturation> voltage_saturation;
  std::optional<AmplifierLag> amplifier_lag;
  std::optional<ChargeRetention> charge_retention;
  std::optional<PolarityAsymmetry> polarity_asymmetry;
  std::optional<ZippingHysteresis> zipping_hysteresis;
  std::optional<ResidualSet> residual_set;
  std::optional<PouchCreep> pouch_creep;
  std::optional<AddedMass> added_mass;
  std::optional<SpringHardening> spring_hardening;
  std::optional<HystereticSpring> hysteretic_spring;
  std::optional<QuadraticDamping> quadratic_damping;
  std::optional<ExternalForce> external_force;
  std::optional<PeriodicDisturbance> periodic_disturbance;
  std::optional<EndStop> end_stop;
  std::optional<CoulombFriction> coulomb_friction;
  std::optional<StribeckFriction> stribeck_friction;
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

// Calls visit(optional effect) for each effect of the library, in the order in which they act:
//   volts    saturation limits what is asked for; the amplifier follows with its lag; the stack gets u_o of
//            that by eq. (2); retained charge s screens it; polarity scales u_o - s, which is what pulls.
//   pouch    the play asks for a height, the set's floor is the least, oil flows there; what remains of the
//            set, and creep, come on top: x_B = n (H - H_0 + set + creep).
//   plate A  one sum of forces over one mass; dry friction last, because it opposes that sum.
//   reading  plate A through the play, plus the disturbance's motion; that late; scale, drift, offset, noise.
template <class AnyEffects, class Visitor>
void for_each_effect(AnyEffects& effects, Visitor&& visit) {
  visit(effects.voltage_saturation);
  visit(effects.amplifier_lag);
  visit(effects.charge_retention);
  visit(effects.polarity_asymmetry);
  visit(effects.zipping_hysteresis);
  visit(effects.residual_set);
  visit(effects.pouch_creep);
  visit(effects.added_mass);
  visit(effects.spring_hardening);
  visit(effects.hysteretic_spring);
  visit(effects.quadratic_damping);
  visit(effects.external_force);
  visit(effects.periodic_disturbance);
  visit(effects.end_stop);
  visit(effects.coulomb_friction);
  visit(effects.stribeck_friction);
  visit(effects.layer_puncture);
  visit(effects.shaft_friction);
  visit(effects.tissue_relaxation);
  visit(effects.backlash);
  visit(effects.sensor_lag);
  visit(effects.sensor_scale);
  visit(effects.sensor_drift);
  visit(effects.sensor_offset);
  visit(effects.sensor_noise);
}

// One tissue that the needle meets: the same three laws as the effects, one set a layer.
struct TissueLayer {
  LayerPuncture surface;
  ShaftFriction shaft;
  TissueRelaxation relaxation;
};

inline constexpr std::size_t kMaxLayers = 8;

struct PlantModel {
  Baseline baseline;
  Effects effects;
  std::vector<TissueLayer> tissue;  // in order of depth; at most kMaxLayers
  double weight = 0.050;            // kg put on plate A; belongs to a run
  double internal_step = 1e-3;      // s, largest step of the integrator
  std::uint64_t noise_seed = 1;

  // What moves with plate A. An added mass, however negative, leaves a tenth of what is described. kg
  double mass_A() const {
    const double described = baseline.drive == Drive::Force ? baseline.m : baseline.fixture_mass + weight;
    if (!effects.added_mass) return described;
    return std::max(0.1 * described, described + effects.added_mass->mass);
  }
};

}  // namespace biopsy::sim
