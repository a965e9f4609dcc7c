#include "sim/paper/calibration/objective.hpp"

#include <algorithm>
#include <cmath>

#include "robot/common/in_parallel.hpp"
#include "robot/common/statistics.hpp"
#include "safety/types/limits.hpp"
#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"
#include "sim/paper/paper_targets.hpp"
#include "sim/plant/simulate.hpp"

namespace biopsy::sim::calibration {
namespace {

constexpr double kPrior = 0.1;     // weight of a parameter one prior std off, against a number one band off
constexpr double kCentre = 0.15;   // weight of a number's distance from the middle of its band
constexpr double kRoom = 0.03;     // margin by which statements shall hold and bands are narrowed
constexpr double kTip = 0.02;      // bands
constexpr double kRunBand = 0.05;  // rms error of a measured run, of its span, that weighs as much as a band
constexpr double kFarthest = 5.0;  // bands, where a number's loss saturates
constexpr double kUnresolved = 20e-6;  // m, rms: a run without motion contains only noise
constexpr double kRunMost = 20.0;      // bands, the same for a run
constexpr std::size_t kRunReadings = 200;
constexpr double kMostVolts = 1e-3 * limits::kDriveMax_mV;
constexpr double kReachBand = 0.05;  // of the reach

// Its square grows with |miss| at first and saturates at 2, smooth at 0: the sum is least where most rows are
// met and a few are missed by far, rather than where all are missed by a little.
double robust_loss(double miss) {
  const double size = std::abs(miss);
  return std::copysign(std::sqrt(2.0 * (std::hypot(kTip, size) - kTip) / (1.0 + size)), miss);
}

double in_bands(const PaperRow& row) {
  const double ratio = row.ours / row.paper;
  if (!std::isfinite(ratio) || ratio <= 0.0) return kFarthest;
  return std::clamp(std::log(ratio) / row.band, -kFarthest, kFarthest);
}

double reach_miss(PlantModel stage, double reach) {
  stage.weight = paper::kWeight;
  const paper::OpenLoopRun run = paper::run_open_loop(
      stage, {.amplitude = kMostVolts, .frequency = 2.0, .settle = 6.0, .watch = 0.5, .period = 2.5e-3},
      true);
  const double lifted = 1e-3 * mean(run.displacement);
  return std::isfinite(lifted) ? std::clamp((1.0 - lifted / reach) / kReachBand, 0.0, kFarthest) : kFarthest;
}

double pulled(double miss, Pull pull) {
  return pull == Pull::Robust ? robust_loss(miss) : std::min(miss, kFarthest);
}

double row_residual(const PaperRow& row, Pull pull) {
  PaperRow with_room = row;
  with_room.band *= 1.0 - kRoom;
  const double miss = pulled(paper::shortfall(with_room), pull);
  if (row.kind == RowKind::Number)
    return std::copysign(std::hypot(miss, kCentre * in_bands(row)), in_bands(row));
  if (row.kind == RowKind::Trend && row.ok) return std::max(0.0, kRoom - row.margin);
  return row.kind == RowKind::Trend ? miss + kRoom : miss;
}

double span_of(const RecordedRun& run) {
  const auto [low, high] = std::minmax_element(run.displacement.begin(), run.displacement.end());
  return std::max(1e-4, *high - *low);
}

// Error of the model at each sample of a measured run, in bands of the run.
std::vector<double> run_misses(const PlantModel& stage, const RecordedRun& run) {
  PlantModel noiseless = stage;
  noiseless.effects.sensor_noise.reset();
  std::vector<double> misses = simulate(noiseless, run).displacement;
  const double band = kRunBand * span_of(run);
  for (std::size_t i = 0; i < misses.size(); ++i) {
    misses[i] = (misses[i] - run.displacement[i]) / band;
    if (!std::isfinite(misses[i])) misses[i] = kRunMost;
  }
  return misses;
}

double rms_miss(const std::vector<double>& misses) {
  return std::min(rms(misses), kRunMost);
}

// A run has the weight of one number: subsampled to 200 signed residuals, which keeps each parameter's
// sensitivity.
void add_run_readings(const std::vector<double>& misses, std::vector<double>& out) {
  const std::size_t count = std::min<std::size_t>(kRunReadings, misses.size());
  for (std::size_t i = 0; i < count; ++i)
    out.push_back(misses[i * misses.size() / count] / std::sqrt(static_cast<double>(count)));
}

void add_priors(const Eigen::VectorXd& z, std::vector<double>& out) {
  for (const double parameter : z) out.push_back(kPrior * parameter);
}

Eigen::VectorXd as_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

std::vector<paper::FigureEntry> calibrated_figures() {
  std::vector<paper::FigureEntry> figures = paper::all_figures();
  std::erase_if(figures, [](const auto& figure) {
    return figure.number == "2" || figure.number == "4" || figure.number == "beyond";
  });
  return figures;
}

std::vector<PaperRow> rows_at(const Question& question, const Eigen::VectorXd& z, bool parallel) {
  paper::PaperModel model = turned(question.start, question.parameters, z);
  model.brief = true;
  std::vector<std::vector<PaperRow>> found(question.figures.size());
  const auto run = [&](std::size_t i) { found[i] = question.figures[i].run(model).rows; };
  if (parallel)
    in_parallel(found.size(), run);
  else
    for (std::size_t i = 0; i < found.size(); ++i) run(i);
  std::vector<PaperRow> rows;
  for (const std::vector<PaperRow>& some : found)
    std::copy_if(some.begin(), some.end(), std::back_inserter(rows), paper::is_fitted);
  return rows;
}

Eigen::VectorXd residuals(const Question& question, const Eigen::VectorXd& z, bool parallel, Pull pull) {
  std::vector<double> out;
  for (const PaperRow& row : rows_at(question, z, parallel)) out.push_back(row_residual(row, pull));
  const PlantModel stage = turned(question.start, question.parameters, z).stage;
  for (const RecordedRun& run : question.runs) out.push_back(pulled(rms_miss(run_misses(stage, run)), pull));
  if (question.reach > 0.0) out.push_back(reach_miss(stage, question.reach));
  add_priors(z, out);
  return as_vector(out);
}

std::vector<RunFit> run_fits(const Question& question, const Eigen::VectorXd& z) {
  const PlantModel stage = turned(question.start, question.parameters, z).stage;
  std::vector<RunFit> fits;
  for (const RecordedRun& run : question.runs) {
    const double span = span_of(run), band = kRunBand * span, away = band * rms(run_misses(stage, run));
    fits.push_back({run.name, away, span, away <= std::max(band, kUnresolved)});
  }
  return fits;
}

Eigen::VectorXd readings(const Question& question, const Eigen::VectorXd& z, bool parallel) {
  std::vector<double> out;
  for (const PaperRow& row : rows_at(question, z, parallel))
    if (row.kind == RowKind::Number) out.push_back(in_bands(row));
  const PlantModel stage = turned(question.start, question.parameters, z).stage;
  for (const RecordedRun& run : question.runs) add_run_readings(run_misses(stage, run), out);
  add_priors(z, out);
  return as_vector(out);
}

}  // namespace biopsy::sim::calibration
