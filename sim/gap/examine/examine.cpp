#include "sim/gap/examine/examine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/common/statistics.hpp"
#include "sim/gap/millimetres.hpp"
#include "sim/gap/select/evidence_runs.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kNoiseApart = 100.0;     // given over estimated
constexpr double kLargeNoise = 0.02;      // of the range of motion
constexpr double kFewestPerPeriod = 6.0;  // rows of one oscillation
constexpr double kSameInput = 0.01;       // RMS difference, of the input's RMS
constexpr double kRepeats = 0.2;          // RMS difference of repeated runs, of their RMS
constexpr double kRepeatNoises = 10.0;

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  const std::size_t rows = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < rows; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(rows));
}

// A noise that was given in the wrong unit hides every gap.
void add_noise(std::vector<DataRemark>& out, const Dataset& dataset) {
  if (!dataset.sensor_noise || *dataset.sensor_noise <= 0.0) return;
  const double seen = estimated_noise(dataset.runs), given = *dataset.sensor_noise;
  std::vector<double> ranges;
  for (const RecordedRun& run : dataset.runs) ranges.push_back(range_of(run.displacement));
  if (given < kNoiseApart * seen || given < kLargeNoise * median(ranges)) return;
  out.push_back(
      {"unit",
       "sensor_noise_mm",
       {},
       true,
       fmt::format("sensor_noise_mm = {:.4g} is {:.0f} times the scatter of the readings ({:.2g} mm): "
                   "a number in µm? Correct it, or leave it out to have it estimated.",
                   kMm * given, given / seen, kMm * seen)});
}

void add_sampling(std::vector<DataRemark>& out, const Dataset& dataset, const PlantModel& model) {
  const Baseline& b = model.baseline;
  for (const RecordedRun& run : dataset.runs) {
    PlantModel loaded = model;
    loaded.weight = run.weight;
    if (b.k <= 0.0) return;
    const double period = 2.0 * std::numbers::pi * std::sqrt(loaded.mass_A() / b.k);
    if (period > kFewestPerPeriod * run.period) continue;
    out.push_back(
        {"sampling",
         "time_s",
         {run.name},
         false,
         fmt::format("The mechanism oscillates at {:.3g} Hz and is sampled at {:.3g} Hz: its motion "
                     "between two rows is not seen. Record at {:.3g} Hz or more.",
                     1.0 / period, 1.0 / run.period, 2.0 * kFewestPerPeriod / period)});
    return;
  }
}

void add_repeats(std::vector<DataRemark>& out, const Dataset& dataset, double noise) {
  for (std::size_t i = 0; i < dataset.runs.size(); ++i)
    for (std::size_t j = i + 1; j < dataset.runs.size(); ++j) {
      const RecordedRun &a = dataset.runs[i], &b = dataset.runs[j];
      if (a.weight != b.weight || a.external_force != b.external_force ||
          rms_difference(a.input, b.input) > kSameInput * rms(a.input))
        continue;
      const double apart = rms_difference(a.displacement, b.displacement);
      if (apart < std::max(kRepeatNoises * noise, kRepeats * rms(a.displacement))) continue;
      out.push_back(
          {"repeats_differ",
           "displacement_mm",
           {a.name, b.name},
           true,
           fmt::format("Runs {} and {} have the same input and weight, but their displacements differ "
                       "by {:.3g} mm RMS: something that is not in the data set changed between "
                       "them, or input and displacement are exchanged. Find out which, or leave one out.",
                       a.name, b.name, kMm * apart)});
    }
}

}  // namespace

std::vector<DataRemark> examine(const Dataset& dataset, const PlantModel& model, double noise) {
  std::vector<DataRemark> seen = examine_channels(dataset, model.baseline.drive, noise), out;
  const auto blocks = [](const DataRemark& one) { return one.blocks; };
  // First: an exchanged column, for example, looks clipped as well.
  if (std::ranges::none_of(seen, is_unusable)) out = examine_with_model(dataset, model, noise);
  for (DataRemark& one : seen) out.push_back(std::move(one));
  add_noise(out, dataset);
  add_sampling(out, dataset, model);
  if (std::ranges::none_of(out, blocks)) add_repeats(out, dataset, noise);
  std::ranges::stable_partition(out, blocks);
  return out;
}

}  // namespace biopsy::sim::gap
