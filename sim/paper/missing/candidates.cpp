#include "sim/paper/missing/candidates.hpp"

namespace biopsy::sim::missing {

// Starts are off the nominal value where a shape has no influence without the strength.
const std::vector<Candidate>& paper_candidates() {
  static const std::vector<Candidate> kCandidates{
      {"zipping_play",
       "zipping begins at more pressure than it ends at, beside the films' adhesion",
       {{"zipping_hysteresis.width_mm", 0.0, 0.5, 0.0, 0.0, 0.03, true, "Fig. 8b"}}},
      {"second_creep",
       "a second slow time of the pouches, beside the retained charge",
       {{"pouch_creep.share", 0.0, 1.0, 0.0, 0.03, 0.1, true, "Fig. 7a: stable within some per cent"},
        {"pouch_creep.time_s", 0.1, 100.0, 5.0, 5.0, 1.0, false, "between the oil's time and Fig. 12's"}}},
      {"later_height",
       "the films' set adds to the height after a large lift",
       {{"residual_set.added_share", 0.0, 0.5, 0.0, 0.0, 0.05, true, "Fig. 12: does not return to 0"}}},
      {"guide_breakaway",
       "the guides need more force to break away than to slide",
       {{"stribeck_friction.breakaway_N", 0.0, 0.4, 0.0, 0.0, 0.03, true, "IV.D: stick-slip"}}},
      {"quadratic_drag",
       "resistance that grows with the square of the speed",
       {{"quadratic_damping.coefficient_N_s2_per_m2", 0.0, 500.0, 0.0, 0.0, 20.0, true,
         "oil through a narrow gap: some newtons at 0.3 m/s"}}},
      {"hardening_spring",
       "the series spring is stiffer the more it is compressed",
       {{"spring_hardening.cubic_N_per_mm3", 0.0, 0.05, 0.0, 0.0, 0.002, true,
         "a coil spring near its solid length"}}},
      {"averaged_reading",
       "the laser's readings are averaged for longer than 1 ms",
       {{"sensor_lag.time_ms", 0.5, 30.0, 1.0, 1.0, 0.7, false, "usual settings of such lasers"}}},
      {"loop_of_2_ms",
       "the loop iterates every 2 ms with the paper's gains per iteration",
       {},
       {{"loop.period_ms", 2.0}}},
      {"falling_weight",
       "the 50 g of Fig. 11 fall on plate A instead of being put on",
       {{"impact.drop_mm", 0.0, 20.0, 0.0, 0.0, 2.0, true, "a hand's distance"}}},
      {"sticking_joint",
       "the joint of Fig. 12 needs more force to break away than to turn",
       {{"joint.breakaway", 1.0, 6.0, 1.0, 1.0, 1.0, true, "dry bearings: two to three times"}}}};
  return kCandidates;
}

}  // namespace biopsy::sim::missing
