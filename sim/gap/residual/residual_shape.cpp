#include "sim/gap/residual/residual_shape.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/smoothed_motion.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kBins = 20;
constexpr std::size_t kFolds = 6;
constexpr double kWorthShowing = 0.01;
constexpr double kStandardErrors = 2.0;

// One quantity at every row of all runs; NaN where it has no value.
struct Quantity {
  std::string name, unit;
  std::vector<double> values;
};

// Quantities at every row.
struct RowQuantities {
  std::vector<double> input, speed, position, acceleration, reversal, time, weight;
  std::vector<std::size_t> fold;  // rows of one fold are predicted from the others
};

void append(std::vector<double>& to, const std::vector<double>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

RowQuantities row_quantities(const Evidence& evidence, Drive drive, const std::vector<double>& residual) {
  RowQuantities facts;
  std::size_t row_of_all = 0;
  const bool alone = evidence.runs.size() == 1;
  for (std::size_t r = 0; r < evidence.runs.size(); ++r) {
    const EvidenceRun& run = evidence.runs[r];
    std::vector<double> measured, model;
    for (std::size_t i = 0; i < run.rows.size(); ++i, ++row_of_all) {
      const Row& row = run.rows[i];
      measured.push_back(row.measured);
      model.push_back(row.measured - residual[row_of_all]);
      facts.input.push_back(row.input);
      facts.time.push_back(row.time);
      facts.weight.push_back(run.weight);
      facts.fold.push_back(alone ? i * kFolds / run.rows.size() : r % kFolds);
    }
    const SmoothedMotion seen = smoothed_motion(run, measured, evidence.noise);
    const SmoothedMotion motion = smoothed_motion_within(run, model, 0.0, 0.0);
    append(facts.position, model);
    append(facts.speed, motion.v);
    append(facts.acceleration, smoothed_motion_within(run, motion.v, 0.0, 0.0).v);
    append(facts.reversal, since_reversal(run, seen, drive));
  }
  return facts;
}

std::vector<double> scaled(std::vector<double> values, double scale) {
  for (double& value : values) value *= scale;
  return values;
}

std::vector<double> magnitude(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return values;
}

std::vector<Quantity> quantities_of(const RowQuantities& facts, Drive drive, bool alone) {
  const bool force = drive == Drive::Force;
  const std::string name = force ? "force" : "voltage", unit = force ? "N" : "kV";
  const std::vector<double> input = scaled(facts.input, force ? 1.0 : 1e-3);
  std::vector<Quantity> out{{name, unit, input},
                            {name + "_magnitude", unit, magnitude(input)},
                            {"speed", "mm/s", scaled(facts.speed, kMm)},
                            {"position", "mm", scaled(facts.position, kMm)},
                            {"acceleration", "m/s²", facts.acceleration},
                            {"time_since_reversal", "s", facts.reversal}};
  if (alone) return out;
  out.push_back({"time_in_run", "s", facts.time});
  if (!force) out.push_back({"weight", "g", scaled(facts.weight, 1e3)});
  return out;
}

// Upper edges of bins that hold equally many rows; equal values stay together.
std::vector<double> bin_edges(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  std::sort(values.begin(), values.end());
  std::vector<double> edges;
  for (std::size_t b = 1; b <= kBins && !values.empty(); ++b) {
    const double edge = values[b * values.size() / kBins - (b == kBins ? 1 : 0)];
    if (edges.empty() || edge > edges.back()) edges.push_back(edge);
  }
  return edges;
}

// Rows sorted into the bins of one quantity; rows where it has no value have a bin of their own, the last.
struct Bins {
  std::vector<std::size_t> of_row;
  std::size_t count = 0;  // without the last
};

Bins sorted_into_bins(const std::vector<double>& values, const std::vector<double>& edges) {
  Bins bins{.of_row = {}, .count = edges.size()};
  for (const double value : values) {
    const auto found = std::lower_bound(edges.begin(), edges.end(), value);
    bins.of_row.push_back(std::isfinite(value) ? static_cast<std::size_t>(found - edges.begin())
                                               : edges.size());
  }
  return bins;
}

// Sums over the bins, one set for each fold.
struct FoldSums {
  std::vector<double> sum, rows;
  double all = 0.0, all_rows = 0.0;

  explicit FoldSums(std::size_t bins) : sum(bins, 0.0), rows(bins, 0.0) {}
  void add(std::size_t bin, double value) {
    sum[bin] += value, rows[bin] += 1.0, all += value, all_rows += 1.0;
  }
};

// Means of the other folds. A bin that is empty in them takes its neighbour's mean.
std::vector<double> out_of_fold_curve(const std::vector<FoldSums>& folds, std::size_t left_out,
                                      double others_mean) {
  const std::size_t bins = folds.front().sum.size();
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> curve(bins, nothing);
  for (std::size_t b = 0; b < bins; ++b) {
    double sum = 0.0, rows = 0.0;
    for (std::size_t f = 0; f < folds.size(); ++f)
      if (f != left_out) sum += folds[f].sum[b], rows += folds[f].rows[b];
    if (rows > 0.0) curve[b] = sum / rows;
  }
  std::vector<double> filled = curve;
  for (std::size_t b = 0; b < bins; ++b)
    for (std::size_t away = 1; away < bins && std::isnan(filled[b]); ++away) {
      if (b >= away) filled[b] = curve[b - away];
      if (std::isnan(filled[b]) && b + away < bins) filled[b] = curve[b + away];
    }
  if (std::isnan(curve.back())) filled.back() = others_mean;  // where the quantity has no value
  return filled;
}

double out_of_fold_mean(const std::vector<FoldSums>& folds, std::size_t left_out) {
  double sum = 0.0, rows = 0.0;
  for (std::size_t f = 0; f < folds.size(); ++f)
    if (f != left_out) sum += folds[f].all, rows += folds[f].all_rows;
  return rows > 0.0 ? sum / rows : 0.0;
}

// Share of the squared error that the out-of-fold curve explains; 0 where that is less than two standard
// errors over the folds.
double share_explained(const Bins& bins, const std::vector<std::size_t>& fold,
                       const std::vector<double>& residual) {
  const std::size_t folds = *std::max_element(fold.begin(), fold.end()) + 1;
  std::vector<FoldSums> sums(folds, FoldSums(bins.count + 1));
  for (std::size_t i = 0; i < residual.size(); ++i) sums[fold[i]].add(bins.of_row[i], residual[i]);
  std::vector<double> means, gains(folds, 0.0);
  std::vector<std::vector<double>> curves;
  for (std::size_t f = 0; f < folds; ++f) {
    means.push_back(out_of_fold_mean(sums, f));
    curves.push_back(out_of_fold_curve(sums, f, means[f]));
  }
  double total = 0.0, gained = 0.0, scatter = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double plain = residual[i] - means[fold[i]], left = residual[i] - curves[fold[i]][bins.of_row[i]];
    total += plain * plain;
    gains[fold[i]] += plain * plain - left * left;
  }
  for (const double gain : gains) gained += gain;
  const double n = static_cast<double>(folds);
  for (const double gain : gains) scatter += (gain - gained / n) * (gain - gained / n);
  const double standard_error = std::sqrt(scatter * n / (n - 1.0));  // of the sum
  return total > 0.0 && gained > kStandardErrors * standard_error ? gained / total : 0.0;
}

ResidualShape shape_of(const Quantity& quantity, const Bins& bins, const std::vector<double>& residual) {
  ResidualShape shape{.quantity = quantity.name, .unit = quantity.unit, .at = {}, .mean = {}, .count = {}};
  std::vector<double> at(bins.count, 0.0), sum(bins.count, 0.0), rows(bins.count, 0.0);
  for (std::size_t i = 0; i < residual.size(); ++i)
    if (const std::size_t b = bins.of_row[i]; b < bins.count)
      at[b] += quantity.values[i], sum[b] += residual[i], rows[b] += 1.0;
  for (std::size_t b = 0; b < bins.count; ++b) {
    if (rows[b] == 0.0) continue;
    shape.at.push_back(at[b] / rows[b]);
    shape.mean.push_back(kMm * sum[b] / rows[b]);
    shape.count.push_back(rows[b]);
  }
  return shape;
}

}  // namespace

std::vector<ResidualShape> residual_shapes(const Evidence& evidence, const PlantModel& model,
                                           const std::vector<double>& residual) {
  const Drive drive = model.baseline.drive;
  const RowQuantities facts = row_quantities(evidence, drive, residual);
  assert(facts.fold.size() == residual.size());
  std::vector<ResidualShape> out;
  for (const Quantity& quantity : quantities_of(facts, drive, evidence.runs.size() == 1)) {
    const std::vector<double> edges = bin_edges(quantity.values);
    if (edges.size() < 2) continue;  // constant
    const Bins bins = sorted_into_bins(quantity.values, edges);
    const double share = share_explained(bins, facts.fold, residual);
    if (share < kWorthShowing) continue;
    out.push_back(shape_of(quantity, bins, residual));
    out.back().share_explained = share;
  }
  std::stable_sort(out.begin(), out.end(), [](const ResidualShape& a, const ResidualShape& b) {
    return a.share_explained > b.share_explained;
  });
  return out;
}

}  // namespace biopsy::sim::gap
