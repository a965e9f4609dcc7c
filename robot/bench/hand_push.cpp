#include "robot/bench/hand_push.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace biopsy::robot {
namespace {

constexpr double kBefore_s = 1.0;       // tells the scatter, before the first
constexpr double kLongest_s = 6.0;      // as long as the stage stands between two changes
constexpr double kScatters = 6.0;       // beyond doubt
constexpr double kLeast_m = 0.03e-3;    // three times a good laser's noise
constexpr std::size_t kSmoothed = 10;   // rows
constexpr double kLasts_s = 0.02;       // longer than an outlier
constexpr double kBeginning = 1.0 / 3;  // of what is beyond doubt: looked for backwards

// What the depth does that it did not do one drive period before, the laser's noise smoothed.
class Novelty {
 public:
  Novelty(const std::vector<double>& depth, std::size_t period_rows) : changes_(depth.size(), 0.0) {
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
  double mean, doubtless;  // m: what is beyond doubt, from the mean
};

Quiet quiet_of(const Novelty& novelty, std::size_t from, std::size_t to) {
  const double mean = novelty.mean(from, to);
  return {mean, std::max(kLeast_m, kScatters * novelty.scatter(from, to, mean))};
}

// The row in [asked, end) from which the depth goes `direction`; `end` where it never does.
std::size_t began(const Novelty& novelty, const Quiet& quiet, std::size_t asked, std::size_t end,
                  double direction, std::size_t lasts) {
  const auto moved = [&](std::size_t row) { return direction * (novelty.at(row) - quiet.mean); };
  const double faint = kBeginning * quiet.doubtless;
  while (asked < end && std::abs(moved(asked)) > faint) ++asked;  // what a late hand did before
  std::size_t in_a_row = 0, row = asked;
  for (; row < end && in_a_row < lasts; ++row) in_a_row = moved(row) > quiet.doubtless ? in_a_row + 1 : 0;
  if (in_a_row < lasts) return end;
  row -= lasts;
  while (row > asked && moved(row) > faint) --row;
  return row;
}

}  // namespace

std::vector<HandPush> date_by_depth(sim::RecordedRun& run, std::size_t period_rows, std::size_t end) {
  const auto rows_in = [&](double seconds) {
    return static_cast<std::size_t>(std::llround(seconds / run.period));
  };
  const Novelty novelty(run.displacement, period_rows);
  const std::vector<double> asked = run.external_force;
  std::optional<Quiet> quiet;
  std::vector<HandPush> pushes;
  std::size_t next = 1;
  for (std::size_t row = 1; row < std::min(end, asked.size()); row = next) {
    next = row + 1;
    if (asked[row] == asked[row - 1]) continue;
    while (next < asked.size() && asked[next] == asked[row]) ++next;
    const std::size_t before = rows_in(kBefore_s), until = std::min({next, end, row + rows_in(kLongest_s)});
    if (!quiet && row >= before + period_rows) quiet = quiet_of(novelty, row - before, row);
    const double direction = asked[row] > asked[row - 1] ? -1.0 : 1.0;  // a push lowers plate A
    const std::size_t from = quiet ? began(novelty, *quiet, row, until, direction, rows_in(kLasts_s)) : until;
    HandPush push{.asked_s = run.time[row], .force_N = asked[row], .seen = from < until};
    const std::size_t begins = push.seen ? from : row;
    push.began_s = run.time[begins];
    // Until then what lay there before still does.
    for (std::size_t k = row; k < begins; ++k) run.external_force[k] = run.external_force[row - 1];
    pushes.push_back(push);
  }
  return pushes;
}

}  // namespace biopsy::robot
