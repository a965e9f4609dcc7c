#include "sim/gap/residual/run_fit.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "sim/gap/millimetres.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::size_t kLags = 25;  // rows
constexpr double kBound = 2.576;   // standard deviations: 99 % of the lags of white noise lie within

std::vector<double> centred(std::span<const double> values) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  std::vector<double> out;
  for (const double value : values) out.push_back(value - mean);
  return out;
}

double square_sum(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum;
}

// Largest |correlation| of `a` with `b` `lag` rows earlier, lags from `first` on; both centred.
double largest_correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t first) {
  const double size = std::sqrt(square_sum(a) * square_sum(b));
  double most = 0.0;
  for (std::size_t lag = first; lag <= kLags && lag < a.size() && size > 0.0; ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < a.size(); ++i) sum += a[i] * b[i - lag];
    most = std::max(most, std::abs(sum) / size);
  }
  return most;
}

double fit_percent(std::span<const double> residual, const std::vector<double>& motion) {
  double left = 0.0;
  for (const double value : residual) left += value * value;
  const double all = square_sum(motion);
  return all > 0.0 ? 100.0 * (1.0 - std::sqrt(left / all)) : 0.0;
}

RunFit fit_of(const EvidenceRun& run, std::size_t from, std::size_t to, const double* before,
              const double* after) {
  std::vector<double> measured, input;
  for (std::size_t i = from; i < to; ++i)
    measured.push_back(run.rows[i].measured), input.push_back(run.rows[i].input);
  const std::vector<double> motion = centred(measured), driven = centred(input);
  const std::span left_before(before + from, to - from), left_after(after + from, to - from);
  const std::vector<double> left = centred(left_after);
  return {.run = run.name,
          .held_out = from >= run.training_rows,
          .before_percent = fit_percent(left_before, motion),
          .after_percent = fit_percent(left_after, motion),
          .whiteness = largest_correlation(left, left, 1),
          .input_correlation = largest_correlation(left, driven, 0),
          .bound = kBound / std::sqrt(static_cast<double>(to - from))};
}

}  // namespace

std::vector<RunFit> run_fits(const Evidence& evidence, const std::vector<double>& before,
                             const std::vector<double>& after) {
  std::vector<RunFit> out;
  std::size_t first = 0;
  for (const EvidenceRun& run : evidence.runs) {
    const std::size_t all = run.rows.size();
    if (run.training_rows > 0)
      out.push_back(fit_of(run, 0, run.training_rows, &before[first], &after[first]));
    if (run.training_rows < all)
      out.push_back(fit_of(run, run.training_rows, all, &before[first], &after[first]));
    first += all;
  }
  return out;
}

double held_out_motion(const Evidence& evidence) {
  double square = 0.0;
  std::size_t rows = 0;
  for (const EvidenceRun& run : evidence.runs) {
    std::vector<std::size_t> ends;
    for (const WindowStart& window : run.windows)
      if (window.row > run.training_rows) ends.push_back(window.row);
    ends.push_back(run.rows.size());
    std::size_t from = run.training_rows;
    for (const std::size_t to : ends) {
      std::vector<double> measured;
      for (std::size_t i = from; i < to; ++i) measured.push_back(run.rows[i].measured);
      square += square_sum(centred(measured));
      rows += to - from;
      from = to;
    }
  }
  return rows > 0 ? std::sqrt(square / static_cast<double>(rows)) : 0.0;
}

std::vector<GapSignals> signals(const Evidence& evidence, const std::vector<double>& before,
                                const std::vector<double>& after) {
  std::vector<GapSignals> out;
  std::size_t at = 0;
  for (const EvidenceRun& run : evidence.runs) {
    GapSignals one;
    one.run = run.name;
    one.training_rows = run.training_rows;
    for (const Row& row : run.rows) {
      one.time.push_back(row.time);
      one.input.push_back(row.input);
      one.measured.push_back(kMm * row.measured);
      one.before.push_back(kMm * (row.measured - before[at]));
      one.after.push_back(kMm * (row.measured - after[at]));
      ++at;
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace biopsy::sim::gap
