// The needle stage and what surrounds it, as constants: nothing here changes while it moves.
// Source: Xiong, Zhou, Li, Yeow, eq. (1)-(21); docs/explanation/model.md says where the paper is silent or
// misprinted. SI units.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/effects/effect_list.hpp"
#include "sim/plant/brake.hpp"
#include "sim/term/term.hpp"

namespace biopsy::sim {

inline constexpr double kVacuumPermittivity = 8.8541878128e-12;  // F/m, CODATA 2018

enum class Drive : std::uint8_t {
  Stack,  // voltage on the pouches
  Force,  // a measured force on plate A: mechanical data without a HASEL stack
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

// One tissue that the needle meets: the laws of the tissue effects, one set a layer.
struct TissueLayer {
  LayerPuncture surface;
  ShaftFriction shaft;
  TissueRelaxation relaxation;
};

inline constexpr std::size_t kMaxLayers = 8;

struct PlantModel {
  Baseline baseline;
  Effects effects;
  std::optional<Brake> brake;       // none: the stage cannot lock the needle
  std::vector<TissueLayer> tissue;  // in order of depth; at most kMaxLayers
  std::vector<Term> terms;          // by name; at most kMostTerms
  double weight = 0.050;            // kg put on plate A; belongs to a run
  double internal_step = 1e-3;      // s, largest step of the integrator
  std::uint64_t noise_seed = 1;

  // Mass that moves with plate A; at least a tenth of the described one, however negative an added mass. kg
  double mass_A() const {
    const double described = baseline.drive == Drive::Force ? baseline.m : baseline.fixture_mass + weight;
    double mass = described;
    for_each_present(effects, [&]<class E>(const E& effect) {
      if constexpr (requires { &E::added_mass; }) mass += effect.added_mass();
    });
    return std::max(0.1 * described, mass);
  }
};

}  // namespace biopsy::sim
