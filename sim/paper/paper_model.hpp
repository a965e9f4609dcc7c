// Model of all the paper's experiments: one needle stage, the films of the other two materials, and the
// mechanisms on the stage in Fig. 12 and 13. SI units.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::paper {

// Electrical properties of a pouch by its material; size and oil are the same (paper IV.A).
struct Film {
  double K = 0.80;         // C1/(C1+C2)
  double tau = 6.9;        // s, R (C1+C2)
  double eps_film = 3.4;   // relative permittivity
  double d_film = 100e-6;  // m, both films of a zipped pouch
};

// Rotary joint, IV.F.1: a link-slider mechanism that plate A carries.
struct Joint {
  double mass = 0.050;  // kg carried by plate A: link, output shaft's inertia and load as felt at the slider
  double friction = 0.050;  // N, dry friction of its bearings as felt at the slider
  double breakaway = 1.0;   // times that from rest
  double crank = 10e-3;     // m, from the shaft to the link's pin
  double start = 0.0;       // rad, crank at displacement 0, from the perpendicular to the slider
};

// Needle, IV.F.2: 50 g on the fixture, muscle up to `muscle`, an air gap up to `liver`.
struct Needle {
  double muscle = 2.0e-3;  // m, thickness of the chicken breast, IV.F.2
  double liver = 2.9e-3;   // m, where the liver begins: 2 mm and the 0.9 mm gap
  std::vector<TissueLayer> tissue;
};

struct PaperModel {
  std::string name;   // of the stage's file
  PlantModel stage;   // 50 um PI, 11 pouches: the needle stage
  Film pi25, bopp25;  // 25 um PI, 25 um pre-coated BOPP: Fig. 6 alone
  Joint joint;
  Needle needle;
  double loop_period = 1e-3;  // s, of the loop in Fig. 9 to 13: 1 ms by IV.D
  double drop = 0.0;          // m, from which the 50 g of Fig. 11 fall
  // For calibration: shorter runs. Rows differ by less than 1 %.
  bool brief = false;
};

// `stage` is a model file. `paper` holds the other films and the mechanisms (sim/models/paper.toml: tables
// [film.pi25], [film.bopp25], [joint], [needle]); tissues.toml beside it holds the needle's tissues. Every
// value may be a number or { value, std, source }, as in model files. Throws ConfigError.
PaperModel read_paper_model(const std::filesystem::path& stage, const std::filesystem::path& paper);

// The stage with another film, without retained charge, which is known only of the stage's own film.
PlantModel with_film(PlantModel stage, const Film& film);

}  // namespace biopsy::sim::paper
