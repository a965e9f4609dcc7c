#include "sim/gap/select/evidence_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"
#include "sim/gap/examine/examine.hpp"
#include "sim/gap/residual/noise_estimate.hpp"
#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/window_starts.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::gap {
namespace {

// Step times the fastest rate. Third order: 0.25 loses 2e-3 of a free oscillation's amplitude over its decay,
// 0.125 loses 1e-4.
constexpr double kCoarse = 0.25, kFine = 0.125;
// Of a model that an effect makes faster: it rings only for a moment, at a surface that gives way for
// example, and a search needs to know only about when.
constexpr double kCoarseStiff = 0.5, kFineStiff = 0.16;
constexpr double kStiffest = 8.0;      // times the given model's rate, beyond which steps become no shorter
constexpr double kLongestSpan = 5e-3;  // s
constexpr double kInputTolerance = 0.01;  // of the largest input: rows that differ more stay apart
constexpr std::size_t kFewestRows = 50;
// Steps of the given model's integrator through all runs; half as many of a stack's, which take twice as
// long.
constexpr double kMostCoarseSteps = 1.6e5, kMostFineSteps = 4e5;
constexpr double kMostStiffSteps = 4e5;  // however stiff an effect makes the model

bool joins(const RecordedRun& run, std::size_t first, std::size_t row, double tolerance) {
  return std::abs(run.input[row] - run.input[first]) <= tolerance &&
         run.external_force[row] == run.external_force[first];
}

// Rows of `recorded`, joined where input and force hardly change; a window always begins a row.
std::vector<Row> joined_rows(const RecordedRun& recorded, double longest, double tolerance,
                             const std::vector<std::size_t>& window_rows, std::vector<std::size_t>& begins) {
  std::vector<Row> rows;
  const std::size_t n = recorded.time.size();
  auto window = window_rows.begin();
  for (std::size_t i = 0; i < n;) {
    while (window != window_rows.end() && *window <= i) ++window;
    const std::size_t limit = window == window_rows.end() ? n : *window;
    const std::size_t most =
        std::max<std::size_t>(1, static_cast<std::size_t>(longest / recorded.period + 1e-6));
    std::size_t end = i + 1;
    double sum = recorded.input[i];
    while (end < limit && end - i < most && joins(recorded, i, end, tolerance)) sum += recorded.input[end++];
    const double span =
        (end < n ? recorded.time[end] : recorded.time[n - 1] + recorded.period) - recorded.time[i];
    rows.push_back({recorded.time[i] - recorded.time[0], span, sum / static_cast<double>(end - i),
                    recorded.external_force[i], recorded.displacement[i]});
    begins.push_back(i);
    i = end;
  }
  return rows;
}

EvidenceRun prepare_run(const RecordedRun& recorded, const PlantModel& model, std::optional<double> window,
                        double noise, double step_share) {
  EvidenceRun run{.name = recorded.name, .weight = recorded.weight, .rows = {}, .windows = {}};
  std::vector<std::size_t> window_rows, begins;
  if (window) {
    const auto rows =
        std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(*window / recorded.period)));
    for (std::size_t i = 0; i < recorded.time.size(); i += rows) window_rows.push_back(i);
  }
  double u_max = 0.0;
  for (const double u : recorded.input) u_max = std::max(u_max, std::abs(u));
  // A force acts through its mean; a voltage through its square, so its jumps must stay where they are.
  const double tolerance = model.baseline.drive == Drive::Force ? u_max * 2.0 : u_max * kInputTolerance;
  const double longest = std::min(kLongestSpan, step_share / fastest_rate(model));
  run.rows = joined_rows(recorded, longest, tolerance, window_rows, begins);
  const std::vector<StartMotion> starts = window_starts(recorded, window_rows, noise);
  for (std::size_t i = 0; i < window_rows.size(); ++i) {
    const auto at = std::lower_bound(begins.begin(), begins.end(), window_rows[i]) - begins.begin();
    run.windows.push_back({static_cast<std::size_t>(at), starts[i].x, starts[i].v});
  }
  return run;
}

// Which rows train: as the data set says; otherwise hold_out() decides.
void assign_roles(std::vector<EvidenceRun>& runs, const std::vector<RecordedRun>& recorded) {
  for (std::size_t i = 0; i < runs.size(); ++i)
    runs[i].training_rows = recorded[i].role == RunRole::Test ? 0 : runs[i].rows.size();
}

void measure_range(Evidence& evidence) {
  evidence.x_low = std::numeric_limits<double>::infinity();
  evidence.x_high = -evidence.x_low;
  for (const EvidenceRun& run : evidence.runs)
    for (const Row& row : run.rows) {
      evidence.x_low = std::min(evidence.x_low, row.measured);
      evidence.x_high = std::max(evidence.x_high, row.measured);
      evidence.u_max = std::max(evidence.u_max, std::abs(row.input));
    }
}

void measure_seconds(Evidence& evidence) {
  evidence.training_seconds = evidence.held_out_seconds = 0.0;
  for (const EvidenceRun& run : evidence.runs)
    for (std::size_t i = 0; i < run.rows.size(); ++i)
      (i < run.training_rows ? evidence.training_seconds : evidence.held_out_seconds) += run.rows[i].span;
}

double recorded_seconds(const Dataset& dataset) {
  double out = 0.0;
  for (const RecordedRun& run : dataset.runs) out += run.period * static_cast<double>(run.time.size());
  return out;
}

// Of the readings, those that differ from the one before where a sensor has steps; all where it has none.
double independent_share(const Dataset& dataset) {
  double own = 0.0, all = 0.0;
  for (const RecordedRun& run : dataset.runs) {
    const std::vector<double>& x = run.displacement;
    const bool steps = quantisation_step(x) > 0.0;
    for (std::size_t i = 1; i < x.size(); ++i) own += !steps || x[i] != x[i - 1] ? 1.0 : 0.0;
    all += static_cast<double>(x.size() - 1);
  }
  return own / all;
}

// The beginning of a run.
void shorten(EvidenceRun& run, double share) {
  const auto kept = static_cast<std::size_t>(std::ceil(share * static_cast<double>(run.rows.size())));
  run.rows.resize(std::min(run.rows.size(), std::max(kept, kFewestRows)));
  std::erase_if(run.windows, [&](const WindowStart& window) { return window.row >= run.rows.size(); });
}

// Of all runs, so that a simulation takes `most` steps.
void shorten_to(Evidence& evidence, const Dataset& dataset, const PlantModel& model, double most) {
  const double dear = model.baseline.drive == Drive::Stack ? 2.0 : 1.0;
  const double steps = dear * recorded_seconds(dataset) / integrator_step(model, evidence);
  if (steps <= most) return;
  evidence.searched = most / steps;
  for (EvidenceRun& run : evidence.runs) shorten(run, evidence.searched);
}

}  // namespace

void hold_out(Evidence& evidence, HeldOut which) {
  if (evidence.roles_given) return;
  if (evidence.runs.size() == 1) which = HeldOut::LastThirds;
  for (std::size_t i = 0; i < evidence.runs.size(); ++i) {
    EvidenceRun& run = evidence.runs[i];
    if (which == HeldOut::LastThirds)
      run.training_rows = run.rows.size() * 2 / 3;
    else
      run.training_rows = i % 3 == static_cast<std::size_t>(which) ? 0 : run.rows.size();
  }
  measure_seconds(evidence);
}

double estimated_noise(const std::vector<RecordedRun>& runs) {
  return estimate_noise(runs).value;
}

void check_window(const Dataset& dataset, double window) {
  for (const RecordedRun& run : dataset.runs) {
    const double length = run.period * static_cast<double>(run.time.size());
    if (window > length)
      throw ConfigError(fmt::format("a window of {} s is longer than run \"{}\", which has {:.3g} s", window,
                                    run.name, length),
                        "--window",
                        "give a shorter window, or leave --window out to simulate each run in one piece");
    if (window < 2.0 * run.period)
      throw ConfigError(
          fmt::format("a window of {} s holds less than two rows of run \"{}\", which come every {} s",
                      window, run.name, run.period),
          "--window", "give a longer window");
  }
}

double noise_of(const Dataset& dataset) {
  if (!dataset.sensor_noise || *dataset.sensor_noise <= 0.0) return estimated_noise(dataset.runs);
  double noise = *dataset.sensor_noise;
  for (const RecordedRun& run : dataset.runs)
    noise = std::max(noise, quantisation_step(run.displacement) / std::sqrt(12.0));
  return noise;
}

Evidence prepare(const Dataset& dataset, const PlantModel& model, std::optional<double> window,
                 Sampling sampling) {
  Evidence evidence;
  if (dataset.runs.empty())
    throw ConfigError("the data set has no run", dataset.title, "add at least one [[run]] with a file");
  for (const RecordedRun& run : dataset.runs)
    if (run.time.size() < kFewestRows)
      throw ConfigError(fmt::format("run \"{}\" has {} rows, too few to compare", run.name, run.time.size()),
                        run.file, fmt::format("record at least {} rows", kFewestRows));
  const double most = sampling == Sampling::Coarse ? kMostCoarseSteps : kMostFineSteps;
  evidence.step_share = sampling == Sampling::Coarse ? kCoarse : kFine;
  evidence.stiff_step_share = sampling == Sampling::Coarse ? kCoarseStiff : kFineStiff;
  evidence.shortest_step =
      std::max(std::min(kLongestSpan, evidence.step_share / fastest_rate(model)) / kStiffest,
               recorded_seconds(dataset) / kMostStiffSteps);
  evidence.noise_given = dataset.sensor_noise.has_value() && *dataset.sensor_noise > 0.0;
  evidence.noise = noise_of(dataset);
  evidence.independent = independent_share(dataset);
  evidence.noise_std = evidence.noise_given ? 0.0 : estimate_noise(dataset.runs).std;
  evidence.tissue = dataset.tissue.value_or(model.baseline.drive == Drive::Stack);
  for (const RecordedRun& run : dataset.runs)
    evidence.runs.push_back(prepare_run(run, model, window, evidence.noise, evidence.step_share));
  for (const RecordedRun& run : dataset.runs) evidence.period = std::max(evidence.period, run.period);
  measure_range(evidence);
  shorten_to(evidence, dataset, model, most);
  evidence.roles_given = dataset.runs.front().role != RunRole::Unassigned;
  if (evidence.roles_given) assign_roles(evidence.runs, dataset.runs);
  hold_out(evidence, HeldOut::FromSecond);
  measure_seconds(evidence);
  return evidence;
}

}  // namespace biopsy::sim::gap
