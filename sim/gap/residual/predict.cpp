#include "sim/gap/residual/predict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "robot/common/in_parallel.hpp"
#include "sim/plant/stepper.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kLongestStep = 5e-3;  // s

constexpr double kStackStep = 2.0;     // times the work of a mechanism's
constexpr double kStable = 1.0;        // step times rate, of a decay that no reading shows
constexpr double kDampingLeads = 0.8;  // of the fastest rate

// A heavily damped mechanism reaches the speed of its force within less than a reading: that decay has only
// to stay stable, not to be followed.
double step_share(const PlantModel& model, const Evidence& evidence, double rate) {
  const double decay = model.baseline.c_s / model.mass_A();
  const bool unseen = decay * evidence.period > kStable && decay > kDampingLeads * rate;
  return model.baseline.drive == Drive::Force && unseen ? kStable : evidence.stiff_step_share;
}

constexpr int kPhases = 36, kHalvings = 20;  // of 10 degrees: down to 1e-5 degrees

// The phase of the disturbance that fits the measured rows best. The model is nearly linear in a small
// disturbance: three predictions, 90 degrees apart, span all phases.
double best_phase(PlantModel model, const Evidence& evidence, const EvidenceRun& run, std::size_t rows) {
  PeriodicDisturbance& wave = *model.effects.periodic_disturbance;
  std::array<std::vector<double>, 3> predictions;
  for (std::size_t k = 0; k < predictions.size(); ++k) {
    wave.phase = 0.5 * std::numbers::pi * static_cast<double>(k);
    predictions[k] = predict(model, evidence, run, rows);
  }
  double aa = 0.0, ab = 0.0, bb = 0.0, ra = 0.0, rb = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const double mean = 0.5 * (predictions[0][i] + predictions[2][i]);
    const double a = predictions[0][i] - mean, b = predictions[1][i] - mean, r = run.rows[i].measured - mean;
    aa += a * a, ab += a * b, bb += b * b, ra += r * a, rb += r * b;
  }
  const auto misfit = [&](double phase) {
    const double c = std::cos(phase), s = std::sin(phase);
    return c * c * aa + 2.0 * c * s * ab + s * s * bb - 2.0 * (c * ra + s * rb);
  };
  double step = 2.0 * std::numbers::pi / kPhases, best = 0.0;
  for (int k = 1; k < kPhases; ++k)
    if (misfit(k * step) < misfit(best)) best = k * step;
  for (int i = 0; i < kHalvings; ++i) {
    step *= 0.5;
    for (const double phase : {best - step, best + step})
      if (misfit(phase) < misfit(best)) best = phase;
  }
  return best;
}

}  // namespace

// For everything but an end stop, where step() cuts its steps itself. Bristles are cut no finer than this. A
// mechanism's stiffness is that over its measured range.
double integrator_step(PlantModel model, const Evidence& evidence) {
  model.effects.end_stop.reset();
  const double rate = model.baseline.drive == Drive::Stack
                          ? fastest_rate(model)
                          : fastest_rate(model, std::max(-evidence.x_low, evidence.x_high));
  return std::clamp(step_share(model, evidence, rate) / rate, evidence.shortest_step, kLongestStep);
}

PlantModel in_step(PlantModel model, const Evidence& evidence, const EvidenceRun& run, std::size_t rows) {
  if (model.effects.periodic_disturbance && rows > 0)
    model.effects.periodic_disturbance->phase = best_phase(model, evidence, run, rows);
  return model;
}

std::vector<double> predict(PlantModel model, const Evidence& evidence, const EvidenceRun& run,
                            std::size_t rows) {
  std::vector<double> out;
  out.reserve(rows);
  visit_rows(std::move(model), evidence, run, rows, [&](const PlantModel& now, const PlantState& state) {
    out.push_back(displacement_reading(now, state));
  });
  return out;
}

void visit_rows(PlantModel model, const Evidence& evidence, const EvidenceRun& run, std::size_t rows,
                const RowVisitor& visit) {
  model.weight = run.weight;
  model.effects.sensor_noise.reset();
  model.internal_step = integrator_step(model, evidence);
  const bool stack = model.baseline.drive == Drive::Stack;
  double steps = 0.0;
  for (std::size_t i = 0; i < rows; ++i) steps += std::ceil(run.rows[i].span / model.internal_step);
  evidence.work->steps += static_cast<std::uint64_t>((stack ? kStackStep : 1.0) * steps);
  PlantState state = at_rest(model);
  Stepper stepper(model);
  auto window = run.windows.begin();
  for (std::size_t i = 0; i < rows; ++i) {
    const Row& row = run.rows[i];
    if (window != run.windows.end() && window->row == i) {
      set_state(model, state, window->x, window->v);
      ++window;
    }
    visit(model, state);
    stepper.advance(model, state,
                    {.voltage = stack ? row.input : 0.0,
                     .force = stack ? 0.0 : row.input,
                     .external_force = row.external_force},
                    Seconds(row.span));
  }
}

std::vector<double> residual(const PlantModel& model, const Evidence& evidence, Part part) {
  struct Piece {
    const EvidenceRun& run;
    std::size_t from, to, at;
  };
  std::vector<Piece> pieces;
  std::size_t rows = 0;
  for (const EvidenceRun& run : evidence.runs) {
    const std::size_t from = part == Part::HeldOut ? run.training_rows : 0;
    const std::size_t to = part == Part::Training ? run.training_rows : run.rows.size();
    if (from >= to) continue;
    pieces.push_back({run, from, to, rows});
    rows += to - from;
  }
  std::vector<double> out(rows);
  in_parallel(pieces.size(), [&](std::size_t k) {
    const auto& [run, from, to, at] = pieces[k];
    const std::vector<double> predicted = predict(in_step(model, evidence, run, to), evidence, run, to);
    for (std::size_t i = from; i < to; ++i) out[at + i - from] = run.rows[i].measured - predicted[i];
  });
  return out;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  if (!std::isfinite(sum)) return std::numeric_limits<double>::infinity();
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace biopsy::sim::gap
