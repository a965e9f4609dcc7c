// What the planner knows of the stage: the numbers of a model file that its own equations need. SI units.
#pragma once

#include <filesystem>

namespace biopsy::planner {

// Names as in the `[baseline]` of a model file (docs: model); the defaults are the reference model's.
struct NominalStage {
  double K = 0.80, tau = 6.9;                         // -, s; eq. (7), (8)
  double eps_film = 3.4, d_film = 100e-6;             // -, m; both films of a zipped pouch
  double L0 = 0.060, V0 = 1.9e-7, H_0 = 0.35e-3;      // m, m^3, m
  double n = 11, tau_h = 0.030;                       // -, s
  double k = 140, fixture_mass = 0.030, m_B = 0.030;  // N/m, kg, kg; the paper's 14 N/m is a slip of units
  double film_loss = 0.0;                             // V, of `[effect.film_hysteresis]`
  double retained_share = 0.0, retained_time = 1.0;   // -, s; of `[effect.charge_retention]`
};

// The rest of the file is not looked at: whoever simulates with it checks it whole. Throws ConfigError where
// a number is missing or out of range, and for a model that a force drives.
NominalStage read_nominal_stage(const std::filesystem::path& model);

}  // namespace biopsy::planner
