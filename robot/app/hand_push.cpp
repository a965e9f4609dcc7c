#include "robot/app/hand_push.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace biopsy::app {
namespace {

constexpr double kBefore_s = 1.0;  // tells the scatter
constexpr double kLongest_s = 4.0;
constexpr double kScatters = 6.0;       // beyond doubt
constexpr double kLeast_m = 0.03e-3;    // three times a good laser's noise
constexpr double kLasts_s = 0.02;       // longer than an outlier
constexpr double kBeginning = 1.0 / 3;  // of what is beyond doubt: looked for backwards

// What the depth does that it did not do one drive period before.
class Novelty {
 public:
  Novelty(const std::vector<double>& depth, std::size_t period_rows) : depth_(depth), period_(period_rows) {}

  double at(std::size_t row) const { return depth_[row] - depth_[row - period_]; }
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
  const std::vector<double>& depth_;
  std::size_t period_;
};

// The row in [asked, end) from which the depth goes `direction`; `end` where it never does.
std::size_t began(const Novelty& novelty, std::size_t first, std::size_t asked, std::size_t end,
                  double direction, std::size_t lasts) {
  const double mean = novelty.mean(first, asked);
  const double doubtless = std::max(kLeast_m, kScatters * novelty.scatter(first, asked, mean));
  const auto moved = [&](std::size_t row) { return direction * (novelty.at(row) - mean); };
  std::size_t in_a_row = 0, row = asked;
  for (; row < end && in_a_row < lasts; ++row) in_a_row = moved(row) > doubtless ? in_a_row + 1 : 0;
  if (in_a_row < lasts) return end;
  row -= lasts;
  while (row > asked && moved(row) > kBeginning * doubtless) --row;
  return row;
}

}  // namespace

std::vector<HandPush> date_by_depth(sim::RecordedRun& run, std::size_t period_rows) {
  const auto rows_in = [&](double seconds) {
    return static_cast<std::size_t>(std::llround(seconds / run.period));
  };
  const Novelty novelty(run.displacement, period_rows);
  const std::vector<double> asked = run.external_force;
  std::vector<HandPush> pushes;
  std::size_t next = 1;
  for (std::size_t row = 1; row < asked.size(); row = next) {
    next = row + 1;
    if (asked[row] == asked[row - 1]) continue;
    while (next < asked.size() && asked[next] == asked[row]) ++next;
    HandPush push{.asked_s = run.time[row], .began_s = run.time[row], .force_N = asked[row]};
    const std::size_t before = rows_in(kBefore_s), end = std::min(next, row + rows_in(kLongest_s));
    if (row >= before + period_rows) {
      const double direction = asked[row] > asked[row - 1] ? -1.0 : 1.0;  // a push lowers plate A
      const std::size_t from = began(novelty, row - before, row, end, direction, rows_in(kLasts_s));
      push.seen = from < end;
      if (push.seen) push.began_s = run.time[from];
    }
    // Until then what lay there before still does.
    const auto until =
        row + static_cast<std::size_t>(std::llround((push.began_s - push.asked_s) / run.period));
    std::fill(run.external_force.begin() + static_cast<std::ptrdiff_t>(row),
              run.external_force.begin() + static_cast<std::ptrdiff_t>(until), run.external_force[row - 1]);
    pushes.push_back(push);
  }
  return pushes;
}

}  // namespace biopsy::app
