#include "sim/paper/missing/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "robot/common/config_error.hpp"

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
      {"capacitance_of_zipping",
       "the films' capacitance grows as they zip",
       {{"zipping_capacitance.growth_per_mm", 0.0, 2.0, 0.0, 0.0, 0.1, true,
         "eq. (2), C2 of the zipped area"}}},
      {"slow_unzipping",
       "pouches open slower than they close",
       {{"slow_unzipping.share", 0.0, 4.0, 0.0, 0.0, 0.2, true, "9a: falling edges lag"}}},
      {"weaker_than_the_square",
       "the films' pressure grows with less than the square of the voltage",
       {{"voltage_power.deficit", 0.0, 0.8, 0.0, 0.0, 0.05, true, "7b beside 8b: loads of most response"}}},
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

std::vector<Candidate> paper_candidates(const std::vector<std::string>& names) {
  const std::vector<Candidate>& all = paper_candidates();
  if (names.empty()) return all;
  for (const std::string& name : names)
    if (std::ranges::find(all, name, &Candidate::name) == all.end()) {
      std::string known;
      for (const Candidate& one : all) known += (known.empty() ? "" : ", ") + one.name;
      throw ConfigError(fmt::format("there is no candidate \"{}\"", name), "--candidates",
                        "choose of: " + known);
    }
  std::vector<Candidate> out;
  std::ranges::copy_if(all, std::back_inserter(out), [&](const Candidate& one) {
    return std::ranges::find(names, one.name) != names.end();
  });
  return out;
}

}  // namespace biopsy::sim::missing
