#include "planner/plan/nominal_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "safety/types/limits.hpp"

namespace biopsy::planner {
namespace {

constexpr double kVacuumPermittivity = 8.8541878128e-12, kGravity = 9.81;

// What a real stage does that the equations do not know.
// Fig. 8b: the hysteresis loop is 30 % of the strain reached, at every load.
constexpr double kHysteresis = 0.30;
constexpr double kFullStroke_mm = limits::kStroke_um * 1e-3;
// Friction of sliders and shaft that can hold the needle in when the drive falls. More than half the weight
// of the plate would be a stage that does not return by itself, which is a fault to be found, not to be
// allowed for.
constexpr double kHoldingFriction_N = 0.3;
constexpr double kZeroError_mm =
    0.5;  // reading below zero that the laser's zero and the fixture's seat explain

constexpr double kProportional_V_per_mm = 800.0;  // K_p of eq. (22)
// P-part at 0.6 mm error: what the loop has built up when the needle, at 1 mm/s, leaves the dead band of the
// pouches.
constexpr double kLoopHeadroom_V = 500.0;
// The part of kTissueForce_N that may vanish in one instant when a layer gives way; the rest is cutting and
// drag. Not more, because with 0.2 N the release rule would keep a lightly loaded stage from reaching its
// depth.
constexpr double kSuddenForce_N = 0.15;

}  // namespace

// Leakage, and the charge that trails it: from +-r at the reversals, r = share tanh(half period / 2 time).
FilmShare film_share(const NominalStage& stage, Seconds half_period) {
  const double a = half_period.count();  // of eq. (11)
  const double decay = std::exp(-a / stage.tau);
  const double start = 2.0 * stage.K / (1.0 + decay), end = start * decay;
  // Mean over the half-period of (start exp(-t / tau))^2.
  const double mean_square = (start * start - end * end) * stage.tau / (2.0 * a);
  const double retained = stage.retained_share * std::tanh(a / (2.0 * stage.retained_time));
  return {start * (1.0 + retained), end * (1.0 - retained), std::sqrt(mean_square)};
}

NominalModel::NominalModel(Grams weight, const NominalStage& stage)
    : stage_(stage), plate_a_kg_(stage.fixture_mass + weight.value * 1e-3) {
  assert(weight >= Grams(0.0) && weight <= kWeightMax);
}

double NominalModel::plate_a_weight() const {
  return plate_a_kg_ * kGravity;
}

// Eq. (21). The films' adhesion takes its loss on the way up.
double NominalModel::pressure_of(double film_volts) const {
  const double acting = std::max(0.0, film_volts - stage_.film_loss);
  return stage_.eps_film * kVacuumPermittivity * acting * acting / (2.0 * stage_.d_film * stage_.d_film);
}

double NominalModel::depth_m(double film_volts, double force_N) const {
  const double spring_force = std::max(0.0, plate_a_weight() + force_N);  // it can only push
  const double plate_a_above_b = (plate_a_weight() - spring_force) / stage_.k;
  const double load = spring_force + stage_.m_B * kGravity;
  const double pressure = pressure_of(film_volts);
  if (pressure <= 0.0) return plate_a_above_b;
  const double zipped = load / (stage_.L0 * pressure);  // S of (19)
  // (18) solved for H, in the form that does not cancel: (sqrt(S^2 + c) - S) = c / (sqrt(S^2 + c) + S).
  const double area = stage_.V0 / stage_.L0;
  const double height = 2.0 * area / (std::hypot(zipped, std::sqrt(std::numbers::pi * area)) + zipped);
  return stage_.n * (std::max(stage_.H_0, height) - stage_.H_0) + plate_a_above_b;
}

Millimetres NominalModel::depth(Volts amplitude, double force_N) const {
  return Millimetres(1e3 * depth_m(film_share(stage_).rms * amplitude.value, force_N));
}

Millimetres NominalModel::depth_on_films(Volts films, double force_N) const {
  return Millimetres(1e3 * depth_m(films.value, force_N));
}

double NominalModel::speed_after_push() const {
  return std::sqrt(stage_.k / plate_a_kg_);
}

double NominalModel::speed_after_voltage() const {
  return speed_after_push() / std::hypot(1.0, speed_after_push() * stage_.tau_h);
}

std::optional<Volts> NominalModel::drive(Millimetres depth, double force_N) const {
  const double spring_force = std::max(0.0, plate_a_weight() + force_N);
  const double plate_b = depth.value * 1e-3 + (spring_force - plate_a_weight()) / stage_.k;
  if (plate_b <= 0.0) return Volts(0.0);
  const double height = stage_.H_0 + plate_b / stage_.n;
  const double zipped = stage_.V0 / (stage_.L0 * height) - std::numbers::pi * height / 4.0;  // (18) for S
  if (zipped <= 0.0) return std::nullopt;
  const double pressure = (spring_force + stage_.m_B * kGravity) / (stage_.L0 * zipped);  // (19)
  const double films =
      stage_.d_film * std::sqrt(2.0 * pressure / (stage_.eps_film * kVacuumPermittivity)) + stage_.film_loss;
  return Volts(films / film_share(stage_).rms);
}

// The lowest of three:
// reach    what holds the depth against kTissueForce_N on the rising branch of the hysteresis, and headroom
// of the loop; release  if a layer gives way and kSuddenForce_N is gone at once, the needle runs ahead and
// the loop's P-part takes
//          K_p * run from the drive: they must balance before the run is the plan's margin of 1 mm. The stage
//          is soft (10 mm/N near 3 mm), so no drive that cuts tissue bounds the loss of all of its force:
//          that is the supervisor's speed rule, and why crossings are slow;
// 8 kV     the build's limit.
Volts NominalModel::drive_limit(Millimetres depth) const {
  const Millimetres strained = depth * (1.0 + kHysteresis);
  const double margin_mm = limits::kDepthMargin_um * 1e-3;
  const Volts most = from_mV(limits::kDriveMax_mV);
  const Volts reach = drive(strained, kTissueForce_N).value_or(most) + Volts(kLoopHeadroom_V);
  const Volts release =
      drive(strained + Millimetres(margin_mm), kTissueForce_N - kSuddenForce_N).value_or(most) +
      Volts(kProportional_V_per_mm * margin_mm);
  return std::min({reach, release, most});
}

std::vector<DepthBand> NominalModel::plausible_depths() const {
  constexpr double kStep_V = 500.0;
  const FilmShare share = film_share(stage_);
  const double holding = std::min(kHoldingFriction_N, 0.5 * plate_a_weight());
  std::vector<DepthBand> bands;
  for (double volts = 0.0; volts <= limits::kDriveMax_mV * 1e-3; volts += kStep_V) {
    // Low: end of the half-period, all tissue force, and a full loop of hysteresis below the equations.
    const double low = 1e3 * depth_m(share.end * volts, kTissueForce_N) - kHysteresis * kFullStroke_mm;
    // High: start of the half-period, on the way down, friction holds, and half a loop above: the equations
    // are already the upper branch of the paper's stage, which lifts 12 mm where they say 16.
    const double high = 1e3 * depth_m(share.start * volts + 2.0 * stage_.film_loss, -holding) +
                        0.5 * kHysteresis * kFullStroke_mm;
    bands.push_back({Volts(volts), Millimetres(std::max(low, -kZeroError_mm)), Millimetres(high)});
  }
  return bands;
}

}  // namespace biopsy::planner
