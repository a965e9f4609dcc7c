#include "tests/sim/gap/generator/hidden_catalogue.hpp"

#include <algorithm>
#include <stdexcept>

namespace biopsy::hidden {
namespace {

using P = HiddenPhysics;

constexpr CatalogueEntry kLibrary[] = {
    {"charge_retention",
     0.030,
     0.080,
     [](P& p, double s) { p.trap_capture = s; },
     {{{"share", 1 / 0.4}, {"time_s", 0, 1 / 0.4}}}},
    {"amplifier_lag", 0.003, 0.010, [](P& p, double s) { p.amplifier_time = s; }},
    {"voltage_saturation", 2400, 1950, [](P& p, double s) { p.saturation = s; }},
    {"polarity_asymmetry", 0.03, -0.10, [](P& p, double s) { p.asymmetry = s; }},
    {"zipping_hysteresis", 0.008e-3, 0.025e-3, [](P& p, double s) { p.zip_radius = s; }},
    {"residual_set", 0.03, 0.10, [](P& p, double s) { p.set_share = s; }},
    {"pouch_creep", 0.06, 0.15, [](P& p, double s) { p.creep_share = s; }},
    {"coulomb_friction", 0.015, 0.050, [](P& p, double s) { p.friction = s; }, {{{"force_N"}}}},
    {"stribeck_friction",
     0.020,
     0.045,
     [](P& p, double s) { p.friction = s, p.breakaway_ratio = 2.0; },
     {{{"sliding_N"}}}},
    {"quadratic_damping", 6.0, 20.0, [](P& p, double s) { p.drag = s; }, {{{"coefficient_N_s2_per_m2"}}}},
    {"spring_hardening", 4e6, 22e6, [](P& p, double s) { p.cubic = s; }, {{{"cubic_N_per_mm3", 1e-9}}}},
    {"hysteretic_spring", 0.030, 0.100, [](P& p, double s) { p.bouc_force = s; }},
    {"backlash", 0.05e-3, 0.20e-3, [](P& p, double s) { p.play = s; }, {{{"gap_mm", 2e3}}}},
    {"end_stop", 3.2e-3, 2.2e-3, [](P& p, double s) { p.stop_at = s; }},
    {"added_mass", 0.006, 0.025, [](P& p, double s) { p.extra_mass = s; }, {{{"mass_g", 1e3}}}},
    {"external_force", 0.020, 0.080, [](P& p, double s) { p.push = s; }, {{{"force_N"}}}},
    {"periodic_disturbance",
     0.010,
     0.040,
     [](P& p, double s) { p.wave_force = s, p.wave_phase_by_run = s > 0.03; },
     {{{"force_N"}, {"frequency_Hz", 0, 0.3}}}},
    {"layer_puncture", 0.060, 0.200, [](P& p, double s) { p.puncture_force = s; }},
    {"shaft_friction",
     8.0,
     25.0,
     [](P& p, double s) { p.shaft_friction = s; },
     {{{"coulomb_N_per_mm", 1e-3}}}},
    {"tissue_relaxation",
     15.0,
     50.0,
     [](P& p, double s) { p.relax_stiffness = s; },
     {{{"stiffness_N_per_mm", 1e-3}, {"time_s", 0, 2}}}},
    {"sensor_lag", 0.006, 0.015, [](P& p, double s) { p.delay = s; }, {{{"delay_ms", 1e3}}}},
    {"sensor_offset", 0.08e-3, -0.30e-3, [](P& p, double s) { p.offset = s; }, {{{"offset_mm", 1e3}}}},
    {"sensor_scale", 0.07, -0.12, [](P& p, double s) { p.gain_error = s; }, {{{"share"}}}},
    {"sensor_drift", 6e-6, 20e-6, [](P& p, double s) { p.drift = s; }, {{{"rate_um_per_s", 1e6}}}},
    {"voltage_threshold", 60, 180, [](P& p, double s) { p.dead_band = s; }, {{{"threshold_V"}}}},
    {"zipping_capacitance",
     400.0,
     2000.0,
     [](P& p, double s) { p.film_growth = s; },
     {{{"growth_per_mm", 0.2e-3}}}},
    {"load_dependent_friction", 0.05, 0.15, [](P& p, double s) { p.side_load = s; }, {{{"share"}}}},
    {"lugre_friction",
     0.020,
     0.045,
     [](P& p, double s) { p.friction = s, p.breakaway_ratio = 2.0, p.bristles = 60e-6; },
     {{{"sliding_N"}}}},
    {"asymmetric_spring", 100, 250, [](P& p, double s) { p.spring_asymmetry = s; }},
    {"piecewise_spring",
     0.8,
     -0.6,
     [](P& p, double s) { p.second_spring = s; },
     {{{"change_N_per_mm", 0.140}, {"place_mm", 0, 0.4}}}},
    {"directional_damping", 0.3, 1.5, [](P& p, double s) { p.valve = s; }, {{{"more_N_s_per_m", -1.0}}}},
    {"slow_unzipping", 0.8, 2.0, [](P& p, double s) { p.slow_fall = s; }, {{{"share"}}}},
    {"voltage_power", 0.08, 0.3, [](P& p, double s) { p.weak_field = s; }, {{{"deficit"}}}},
    {"hardening_hysteresis", 40.0, 120.0, [](P& p, double s) { p.rope = s; }},
};

// Why none of them is a library effect plus small parameters stands beside each.
constexpr CatalogueEntry kOutside[] = {
    // pressure falls with the heat of switching; creep only adds, and does not feel the frequency
    {"heated_permittivity", 0.06, 0.12, [](P& p, double s) { p.heating = s; }},
    // viscous at one place only: unlike shaft friction and quadratic damping
    {"slider_bump", 6.0, 20.0, [](P& p, double s) { p.bump_damping = s; }},
    // random in time and sign: nothing periodic or constant
    {"random_shocks", 0.5, 1.5, [](P& p, double s) { p.shock_force = s; }},
    // stairs without memory: hysteresis has memory and no stairs
    {"zipping_in_ledges", 0.05e-3, 0.12e-3, [](P& p, double s) { p.zip_ledge = s; }},
    // zero mean, forgets in 0.7 s: a drift is a line
    {"speckle_wander", 0.06e-3, 0.2e-3, [](P& p, double s) { p.speckle = s; }},
    // zero mean over 0.9 mm of travel: scale and offset cannot
    {"cyclic_reading_error", 0.07e-3, 0.20e-3, [](P& p, double s) { p.cyclic_error = s; }},
    // error in proportion to speed with zero mean: a lag has a mean
    {"clock_jitter", 0.004, 0.010, [](P& p, double s) { p.clock_jitter = s; }},
    // random in time: saturation repeats
    {"breakdown_events", 0.04, 0.15, [](P& p, double s) { p.breakdown = s; }},
    // tau_h grows within each run: one tau_h misses start or end
    {"thickening_oil", 0.06, 0.2, [](P& p, double s) { p.thickening = s; }},
};

}  // namespace

std::span<const CatalogueEntry> library_effects() {
  return kLibrary;
}
std::span<const CatalogueEntry> outside_effects() {
  return kOutside;
}

const CatalogueEntry& catalogue_entry(const std::string& name) {
  for (const auto entries : {library_effects(), outside_effects()})
    if (const auto found = std::ranges::find(entries, name, &CatalogueEntry::name); found != entries.end())
      return *found;
  throw std::invalid_argument("no hidden effect named " + name);
}

}  // namespace biopsy::hidden
