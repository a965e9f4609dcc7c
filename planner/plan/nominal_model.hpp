// The planner's own idea of the stage at rest: which depth a drive amplitude gives, and which drive a depth
// needs. Equations (15)-(21) of the paper with (20) solved anew (its printed root is dimensionally wrong);
// the simulation does not know this file, and this file does not know the simulation.
#pragma once

#include <optional>
#include <vector>

#include "planner/plan/nominal_stage.hpp"
#include "robot/msg/plan.hpp"

namespace biopsy::planner {

class NominalModel {
 public:
  // `weight`: what is put on the needle fixture. Weights of 0 to 300 g are modelled (the paper loads up to
  // 260 g).
  explicit NominalModel(Grams weight, const NominalStage& stage = {});

  // Steady depth, on the way up, under a 2 Hz square wave of this amplitude while the tissue pushes the
  // needle back with force_N (negative: friction holds it in). Below zero where the push is stronger than the
  // drive.
  Millimetres depth(Volts amplitude, double force_N = 0.0) const;

  // Depth where the films see this voltage, whatever wave made it.
  Millimetres depth_on_films(Volts films, double force_N = 0.0) const;

  // How fast the loaded plate moves at most, mm/s, after a change that lets it settle 1 mm elsewhere: at once
  // (a push on the plate: it swings on the series spring), or as the oil flows (a jump of the voltage).
  double speed_after_push() const;
  double speed_after_voltage() const;

  double plate_a_kg() const { return plate_a_kg_; }  // with its weight

  // The amplitude that holds this depth against force_N: the inverse of depth(). 0 V where the stage is there
  // without drive; nothing where no drive could do it, because the pouches are empty before.
  std::optional<Volts> drive(Millimetres depth, double force_N = 0.0) const;

  // Highest drive a step that ends at `depth` is allowed; the rule and its numbers stand beside the code.
  Volts drive_limit(Millimetres depth) const;

  // Depths that are plausible at a steady amplitude, 0 to 8 kV in steps of 500 V; wide enough for hysteresis,
  // tissue force and friction of a healthy stage, so it finds a wrong gain or offset and does not argue with
  // tissue.
  std::vector<DepthBand> plausible_depths() const;

 private:
  double depth_m(double film_volts, double force_N) const;  // from the voltage that acts on the films
  double pressure_of(double film_volts) const;
  double plate_a_weight() const;  // newtons

  NominalStage stage_;
  double plate_a_kg_;
};

// The share of the drive amplitude that acts on the films under a square wave (2 Hz where nothing is said),
// settled: at the start of a half-period, at its end (equations (16), (17)), and root mean square over it,
// because pressure follows the square.
struct FilmShare {
  double start, end, rms;
};
FilmShare film_share(const NominalStage& stage, Seconds half_period = Seconds(0.25));

inline constexpr Grams kWeightMax{300.0};
inline constexpr double kTissueForce_N =
    1.2;  // tissue and friction against the needle that a step must overcome

}  // namespace biopsy::planner
