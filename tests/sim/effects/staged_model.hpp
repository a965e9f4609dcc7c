// The models and inputs that several claims share.
#pragma once

#include <filesystem>

#include "robot/msg/plan.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/plant.hpp"
#include "sim/tissue/tissue.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim {

inline std::filesystem::path models_folder() {
  return source_dir() / "sim" / "models";
}

// The paper's needle experiment: muscle 2 mm, gap 0.9 mm, liver behind.
inline std::vector<Layer> paper_layers() {
  return {{"muscle", Millimetres(0), Millimetres(2)},
          {"gap", Millimetres(2), Millimetres(2.9)},
          {"liver", Millimetres(2.9), Millimetres(20)}};
}

inline PlantModel rehearsal_with_tissue() {
  PlantModel model = read_model(models_folder() / "rehearsal.toml");
  model.tissue = tissue_along(paper_layers(), read_tissues(models_folder() / "tissues.toml"));
  return model;
}

// A mass with a measured force on it and nothing else: what an effect adds stands alone.
inline PlantModel bare_mass(double damping = 0.0, double spring = 0.0) {
  PlantModel model;
  model.baseline.drive = Drive::Force;
  model.baseline.m = 0.080;
  model.baseline.c_s = damping;
  model.baseline.k = spring;
  return model;
}

// Twenty seconds of up, hold, down, up higher, down, polarity flipping at 2 Hz. V at millisecond k
inline double ramps_and_flips(int k) {
  const double t = k * 1e-3;
  const double amplitude = t < 4    ? 750.0 * t
                           : t < 8  ? 3000.0
                           : t < 12 ? 3000.0 - 500.0 * (t - 8)
                           : t < 16 ? 1000.0 + 1000.0 * (t - 12)
                                    : 5000.0 - 1250.0 * (t - 16);
  return (k / 250) % 2 == 0 ? amplitude : -amplitude;
}

// The state after a constant voltage, V.
inline PlantState held(const PlantModel& model, PlantState state, double voltage, int milliseconds) {
  for (int k = 0; k < milliseconds; ++k) state = step(model, state, {.voltage = voltage}, Seconds(1e-3));
  return state;
}

// The state after a constant force, N.
inline PlantState pushed(const PlantModel& model, PlantState state, double force, int milliseconds) {
  for (int k = 0; k < milliseconds; ++k) state = step(model, state, {.force = force}, Seconds(1e-3));
  return state;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

}  // namespace biopsy::sim
