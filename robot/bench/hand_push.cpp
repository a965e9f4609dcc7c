#include "robot/bench/hand_push.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace biopsy::robot {
namespace {

constexpr double kBefore_s = 1.0;       // scatter is measured, before the first push
constexpr double kLongest_s = 6.0;      // as long as the stage stands between two changes
constexpr double kScatters = 6.0;       // standard deviations that make a change significant
constexpr double kLeast_m = 0.03e-3;    // three times a good laser's noise
constexpr std::size_t kSmoothed = 10;   // rows
constexpr double kLasts_s = 0.02;       // longer than an outlier
constexpr double kBeginning = 1.0 / 3;  // of the significant change: the start is searched backwards to there

// Change of the depth against one drive period before, smoothed over kSmoothed rows.
class PeriodDifference {
 public:
  PeriodDifference(const std::vector<double>& depth, std::size_t period_rows) : changes_(depth.size(), 0.0) {
    double sum = 0.0;
    for (std::size_t row = period_rows; row < depth.size(); ++row) {
      sum += depth[row] - depth[row - period_rows];
      if (row >= period_rows + kSmoothed)
        sum -= depth[row - kSmoothed] - depth[row - kSmoothed - period_rows];
      changes_[row] = sum / kSmoothed;
    }
  }

  double at(std::size_t row) const { return changes_[row]; }
  double mean(std::size_t from, std::size_t to) const {
    double sum = 0.0;
    for (std::size_t row = from; row < to; ++row) sum += at(row);
    return sum / static_cast<double>(to - from);
  }
  double scatter(std::size_t from, std::size_t to, double mean) const {
    double sum = 0.0;
    for (std::size_t row = from; row < to; ++row) sum += (at(row) - mean) * (at(row) - mean);
    return std::sqrt(sum / static_cast<double>(to - from));
  }

 private:
  std::vector<double> changes_;
};

struct Quiet {
  double mean, significant;  // m; the latter from the mean
};

Quiet quiet_of(const PeriodDifference& difference, std::size_t from, std::size_t to) {
  const double mean = difference.mean(from, to);
  return {mean, std::max(kLeast_m, kScatters * difference.scatter(from, to, mean))};
}

// The row in [requested, end) from which the depth goes `direction`; `end` where it never does.
std::size_t began(const PeriodDifference& difference, const Quiet& quiet, std::size_t requested,
                  std::size_t end, double direction, std::size_t lasts) {
  const auto moved = [&](std::size_t row) { return direction * (difference.at(row) - quiet.mean); };
  const double faint = kBeginning * quiet.significant;
  while (requested < end && std::abs(moved(requested)) > faint)
    ++requested;  // a late response to the change before
  std::size_t in_a_row = 0, row = requested;
  for (; row < end && in_a_row < lasts; ++row) in_a_row = moved(row) > quiet.significant ? in_a_row + 1 : 0;
  if (in_a_row < lasts) return end;
  row -= lasts;
  while (row > requested && moved(row) > faint) --row;
  return row;
}

}  // namespace

std::vector<HandPush> date_by_depth(sim::RecordedRun& run, std::size_t period_rows, std::size_t end) {
  const auto rows_in = [&](double seconds) {
    return static_cast<std::size_t>(std::llround(seconds / run.period));
  };
  const PeriodDifference difference(run.displacement, period_rows);
  const std::vector<double> requested = run.external_force;
  std::optional<Quiet> quiet;
  std::vector<HandPush> pushes;
  std::size_t next = 1;
  for (std::size_t row = 1; row < std::min(end, requested.size()); row = next) {
    next = row + 1;
    if (requested[row] == requested[row - 1]) continue;
    while (next < requested.size() && requested[next] == requested[row]) ++next;
    const std::size_t before = rows_in(kBefore_s), until = std::min({next, end, row + rows_in(kLongest_s)});
    if (!quiet && row >= before + period_rows) quiet = quiet_of(difference, row - before, row);
    const double direction = requested[row] > requested[row - 1] ? -1.0 : 1.0;  // a push lowers plate A
    const std::size_t from =
        quiet ? began(difference, *quiet, row, until, direction, rows_in(kLasts_s)) : until;
    HandPush push{.requested_s = run.time[row], .force_N = requested[row], .seen = from < until};
    const std::size_t begins = push.seen ? from : row;
    push.began_s = run.time[begins];
    // Until then the push before remains.
    for (std::size_t k = row; k < begins; ++k) run.external_force[k] = run.external_force[row - 1];
    pushes.push_back(push);
  }
  return pushes;
}

}  // namespace biopsy::robot
