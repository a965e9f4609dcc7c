#include "sim/gap/predict.hpp"

#include <algorithm>
#include <cmath>

#include "sim/plant.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kLongestStep = 5e-3;  // s
constexpr double kGrace =
    1.25;  // rows were joined for the given model; one a little faster still takes them whole

// Steps that follow everything but an end stop: step() itself cuts those that meet it, and only those.
double usual_step(PlantModel model, const Evidence& evidence) {
  model.effects.end_stop.reset();
  return std::clamp(kGrace * evidence.step_share / fastest_rate(model), evidence.shortest_step, kLongestStep);
}

}  // namespace

std::vector<double> predict(PlantModel model, const Evidence& evidence, const EvidenceRun& run,
                            std::size_t rows) {
  model.weight = run.weight;
  model.effects.sensor_noise.reset();
  model.internal_step = usual_step(model, evidence);
  const bool stack = model.baseline.drive == Drive::Stack;
  std::vector<double> out;
  out.reserve(rows);
  PlantState state = at_rest(model);
  auto window = run.windows.begin();
  for (std::size_t i = 0; i < rows; ++i) {
    const Row& row = run.rows[i];
    if (window != run.windows.end() && window->row == i) {
      place(model, state, window->x, window->v);
      ++window;
    }
    out.push_back(displacement_reading(model, state));
    state = step(model, state,
                 {.voltage = stack ? row.input : 0.0,
                  .force = stack ? 0.0 : row.input,
                  .external_force = row.external_force},
                 Seconds(row.span));
  }
  return out;
}

std::vector<double> residual(const PlantModel& model, const Evidence& evidence, Part part) {
  std::vector<double> out;
  for (const EvidenceRun& run : evidence.runs) {
    const std::size_t from = part == Part::HeldOut ? run.training_rows : 0;
    const std::size_t to = part == Part::Training ? run.training_rows : run.rows.size();
    if (from >= to) continue;
    const std::vector<double> model_says = predict(model, evidence, run, to);
    for (std::size_t i = from; i < to; ++i) out.push_back(run.rows[i].measured - model_says[i]);
  }
  return out;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace biopsy::sim::gap
