// One design of the stack: its plant and its figures of merit. Scaled from a stage with a known model: the
// paper's, 3.2 mL of oil in a pouch of 60 by 60 mm.
#pragma once

#include "sim/paper/design/stack_design.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::design {

// Requirements on a stage.
struct Demands {
  double stroke_mm = 5.0;   // twice the depth of the paper's needle (IV.F.2), with reserve
  double push_N = 0.3;      // of tissue on the needle meanwhile: a capsule of sim/models/tissues.toml
  double margin = 2.0;      // guaranteed breakdown over peak field
  double height_mm = 30.0;  // of the stack at rest: it is placed beside a patient in a bore
  double strain = 1.0;      // largest stroke over height: the paper measured 0.5 (IV.C)
};

inline constexpr double kDriveFrequency = 2.0;                                     // Hz, paper IV.B
inline constexpr double kPaperOil_mL = 3.2, kPaperSide_mm = 60.0, kSeam_mm = 3.0;  // III.A

// The known stage's own design, driven with 6 kV.
StackDesign design_of(const PlantModel& known);

// Oil scales V0, the side L0; films d_film; electrodes, films and number of pouches C2 and R (material
// constant R C2); sizes and field the oil flow. C1 is the cable's and stays; so do guide and masses. The
// guide's dry friction and the laser's errors are left out: they hide ripple and are not design variables.
PlantModel plant_of(const PlantModel& known, const StackDesign& design);

// Guaranteed AC strength of a polyimide film of this thickness (um): DuPont Kapton HN, bulletin GS-96-7, ASTM
// D149; linear between the values. V/um
double guaranteed_strength(double film_um);

// Frequency up to which plate A follows a small change of the pouches' equilibrium height to within 3 dB,
// from the plant's equations linearised at load and pressure. Hz
double bandwidth(const PlantModel& plant, double pressure, double load);

// Height of the stack at rest, from oil, chambers and films as in sim/paper/stack_height.hpp. mm
double stack_height_mm(const StackDesign& design);

// Mean and peak to peak of plate A in the periodic state under a square wave, against a push. m
struct Swing {
  double mean = 0.0, peak_to_peak = 0.0;
};
Swing steady_swing(const PlantModel& plant, double amplitude, double push);

DesignedStack evaluate(const PlantModel& known, const StackDesign& design, const Demands& demands);

}  // namespace biopsy::sim::design
