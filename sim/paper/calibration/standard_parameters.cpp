// The parameters of the needle stage. eps_film, d_film, L0, n and the plates' masses are printed in the paper
// (III.A, IV.A) and stay; K, eps_film and d_film act only as K^2 eps_film/d_film^2, so one of them is enough.
#include "sim/paper/calibration/parameters.hpp"

namespace biopsy::sim::calibration {

const std::vector<Parameter>& standard_parameters() {
  static const std::vector<Parameter> kParameters{
      {"K", 0.15, 0.95, 0.80, 0.4712, 0.5, false,
       "model.md; with less, 8 kV give the strain of Fig. 8b and no more"},
      {"tau", 1.0, 40.0, 6.9, 9.064, 0.7, false, "model.md; 50 um PI, Fig. 6"},
      {"charge_retention.share", 0.0, 0.6, 0.10, 0.1782, 0.15, true,
       "Kellaris 2018; Fig. 6: a fast loss, then a slow one"},
      {"charge_retention.time_s", 0.2, 20.0, 3.0, 0.3191, 0.7, false, "Kellaris 2018: seconds"},
      {"V0", 4e-8, 4e-7, 1.9e-7, 7.892e-08, 0.7, false, "model.md; fits the stroke, 8 mm of Fig. 12"},
      {"H_0", 2e-5, 8e-4, 3.5e-4, 6.665e-05, 1.0, false, "model.md"},
      {"tau_h", 5e-3, 0.4, 0.030, 0.05518, 1.0, false, "model.md; HASELs of this size move at tens of hertz"},
      {"k", 60.0, 300.0, 140.0, 112.8, 0.2, false, "model.md; spring of 0.14 N/mm"},
      {"c_k", 5e-3, 2.0, 0.05, 0.03736, 1.0, false, "model.md"},
      {"c_s", 0.1, 10.0, 0.60, 2.89, 0.8, false, "model.md"},
      {"film_hysteresis.loss_V", 0.0, 3000.0, 300.0, 294.6, 300.0, true,
       "Fig. 8b: a loop of 15 % of the height at 3 kV"},
      {"film_hysteresis.presliding_mm", 2e-3, 0.3, 0.02, 0.04531, 0.8, false,
       "ripple passes below it, Fig. 7a"},
      {"hysteretic_spring.stiffness_N_per_mm", 0.02, 6.0, 2.0, 2.161, 0.5, false,
       "friction over presliding: Fig. 8b's 2.5 mm of hysteresis on a stack of some 60 N/m is twice 0.08 N"},
      {"hysteretic_spring.yield_mm", 5e-3, 0.2, 0.04, 0.0278, 0.5, false,
       "presliding of a guide: hundredths of a millimetre; ripple passes below it, Fig. 7a"},
      {"residual_set.floor_share", 0.0, 0.4, 0.05, 0, 0.1, true, "Fig. 12: does not return to 0"},
      {"residual_set.time_s", 5.0, 300.0, 30.0, 28.21, 0.8, false, "tens of seconds, IV.F.1"},
      {"sensor_noise.std_mm", 5e-3, 0.07, 0.020, 0.01907, 0.5, false,
       "laser of III.D: of the 100 mm class, 0.07 mm repeatability"},
      {"film.pi25.tau", 20.0, 5000.0, 200.0, 199.7, 1.0, false, "Fig. 6"},
      {"film.bopp25.tau", 0.1, 20.0, 1.5, 1.514, 1.0, false, "Fig. 6"},
      {"joint.mass_g", 10.0, 150.0, 70.0, 61.82, 0.5, false, "not in the paper"},
      {"joint.friction_N", 0.01, 0.3, 0.05, 0.02588, 0.7, false, "not in the paper"}};
  return kParameters;
}

}  // namespace biopsy::sim::calibration
