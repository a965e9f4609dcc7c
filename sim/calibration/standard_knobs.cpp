// The knobs of the needle stage. eps_film, d_film, L0, n and the plates' masses are printed in the paper
// (III.A, IV.A) and stay; K, eps_film and d_film act only as K^2 eps_film/d_film^2, so one of them is enough.
#include "sim/calibration/knobs.hpp"

namespace biopsy::sim::calibration {

const std::vector<Knob>& standard_knobs() {
  static const std::vector<Knob> kKnobs{
      {"K", 0.15, 0.95, 0.80, 0.55, 0.5, false,
       "model.md; with less, 8 kV give the strain of Fig. 8b and no more"},
      {"tau", 1.0, 40.0, 6.9, 14.8, 0.7, false, "model.md; 50 um PI, Fig. 6"},
      {"charge_retention.share", 0.0, 0.6, 0.10, 0.399, 0.15, true,
       "Kellaris 2018; Fig. 6: a fast loss, then a slow one"},
      {"charge_retention.time_s", 0.2, 20.0, 3.0, 0.433, 0.7, false, "Kellaris 2018: seconds"},
      {"V0", 4e-8, 4e-7, 1.9e-7, 9.03e-08, 0.7, false, "model.md; fits the stroke, 8 mm of Fig. 12"},
      {"H_0", 2e-5, 8e-4, 3.5e-4, 7.65e-05, 1.0, false, "model.md"},
      {"tau_h", 5e-3, 0.4, 0.030, 0.31, 1.0, false,
       "model.md; Fig. 9c asks for more: 0.5 Hz is not followed"},
      {"k", 60.0, 300.0, 140.0, 145.0, 0.2, false, "model.md; spring of 0.14 N/mm"},
      {"c_k", 5e-3, 2.0, 0.05, 0.00884, 1.0, false, "model.md"},
      {"c_s", 0.1, 10.0, 0.60, 2.2, 0.8, false, "model.md"},
      {"stribeck_friction.sliding_N", 5e-3, 0.25, 0.080, 0.0918, 0.5, false,
       "Fig. 8b: 2.5 mm of hysteresis on a stack of some 60 N/m is twice 0.08 N"},
      {"stribeck_friction.breakaway_N", 5e-3, 0.30, 0.085, 0.0392, 0.5, false,
       "of the order of sliding friction"},
      {"stribeck_friction.speed_mm_s", 0.3, 20.0, 2.0, 6.32, 0.7, false,
       "Armstrong-Helouvry 1994: 1 to 10 mm/s"},
      {"zipping_hysteresis.width_mm", 2e-3, 0.5, 0.05, 0.425, 1.0, false, "Fig. 8b: at most 0.2 mm a pouch"},
      {"zipping_hysteresis.free_share", 0.0, 0.95, 0.5, 0.916, 0.25, true,
       "a ripple remains at 2 Hz, Fig. 10"},
      {"residual_set.floor_share", 0.0, 0.4, 0.05, 0.0, 0.1, true, "Fig. 12: does not return to 0"},
      {"residual_set.added_share", 0.0, 0.6, 0.05, 0.0, 0.1, true,
       "Fig. 8b: hysteresis in proportion to strain"},
      {"residual_set.time_s", 5.0, 300.0, 30.0, 80.6, 0.8, false, "tens of seconds, IV.F.1"},
      {"sensor_noise.std_mm", 5e-3, 0.07, 0.020, 0.0138, 0.5, false,
       "laser of III.D: of the 100 mm class, 0.07 mm repeatability"},
      {"film.pi25.tau", 20.0, 5000.0, 200.0, 252.0, 1.0, false, "Fig. 6"},
      {"film.bopp25.tau", 0.1, 20.0, 1.5, 1.39, 1.0, false, "Fig. 6"},
      {"joint.mass_g", 10.0, 150.0, 70.0, 56.5, 0.5, false, "not in the paper"},
      {"joint.friction_N", 0.01, 0.3, 0.05, 0.0366, 0.7, false, "not in the paper"}};
  return kKnobs;
}

}  // namespace biopsy::sim::calibration
