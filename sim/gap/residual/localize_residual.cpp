#include "sim/gap/residual/localize_residual.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

#include "robot/common/statistics.hpp"
#include "sim/gap/millimetres.hpp"
#include "sim/gap/residual/smoothed_motion.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAfterReversal = 0.1;                       // s, the stage's response
constexpr double kRestingStds = 2.0, kRestingShare = 0.01;   // of the speed's noise, of the usual top speed
constexpr double kStuckShortest = 0.02;                      // s, longer than a turning point
constexpr double kConstantFor = 0.1, kConstantShare = 0.01;  // s, of the largest input
constexpr double kSudden = 5.0;                              // times the median speed of deepening
constexpr double kFall = 0.1, kFallTime = 0.1;  // of the range, beyond the model's; s to either side
constexpr double kShortTime = 0.02, kSlightError = 0.05;
constexpr double kUnremarkable = 0.1;  // lift this near to 1

using Mask = std::vector<bool>;

// Measured and modelled motion of one run, and the masks of rows that belong to a regime.
class RunRegimes {
 public:
  RunRegimes(const EvidenceRun& run, const std::vector<double>& residual_before, const Evidence& evidence,
             Drive drive)
      : run_(run), evidence_(evidence) {
    for (const Row& row : run.rows) readings_.push_back(row.measured);
    model_ = readings_;
    for (std::size_t i = 0; i < model_.size(); ++i) model_[i] -= residual_before[i];
    measured_motion_ = smoothed_motion(run, readings_, evidence.noise);
    model_motion_ = smoothed_motion_within(run, model_, 0.0, measured_motion_.half_width);
    since_reversal_ = since_reversal(run, measured_motion_, drive);
  }

  Mask after_reversal() const {
    return mask_where([&](std::size_t i) { return since_reversal_[i] <= kAfterReversal; });
  }
  Mask rising() const {
    return mask_where([&](std::size_t i) { return measured_motion_.v[i] > moving(); });
  }
  Mask falling() const {
    return mask_where([&](std::size_t i) { return measured_motion_.v[i] < -moving(); });
  }
  Mask holding() const {
    const Mask steady = drive_constant();
    return mask_where(
        [&](std::size_t i) { return steady[i] && std::abs(measured_motion_.v[i]) <= moving(); });
  }
  Mask stuck() const;
  Mask drive_between(double low, double high) const {
    return mask_where([&](std::size_t i) {
      return std::abs(run_.rows[i].input) >= low && std::abs(run_.rows[i].input) <= high;
    });
  }
  Mask measured_between(double low, double high) const {
    return mask_where([&](std::size_t i) { return readings_[i] >= low && readings_[i] <= high; });
  }
  Mask between_times(double from, double to) const {  // shares of the run
    const double start = run_.rows.front().time, all = duration(run_);
    return mask_where([&](std::size_t i) {
      const double share = (run_.rows[i].time - start) / all;
      return share >= from && share < to;
    });
  }
  // Row of the fastest deepening where it is a puncture, otherwise the number of rows.
  std::size_t puncture() const;
  Mask from_row_to(std::size_t from, std::size_t to) const {
    return mask_where([&](std::size_t i) { return i >= from && i < to; });
  }

 private:
  template <class Predicate>
  Mask mask_where(Predicate&& question) const {
    Mask mask(run_.rows.size());
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = question(i);
    return mask;
  }
  double moving() const { return moving_threshold(measured_motion_); }
  Mask drive_constant() const;
  std::size_t row_at(double time) const {
    const auto found = std::lower_bound(run_.rows.begin(), run_.rows.end(), time,
                                        [](const Row& row, double t) { return row.time < t; });
    return std::min<std::size_t>(static_cast<std::size_t>(found - run_.rows.begin()), run_.rows.size() - 1);
  }

  const EvidenceRun& run_;
  const Evidence& evidence_;
  std::vector<double> readings_, model_, since_reversal_;
  SmoothedMotion measured_motion_, model_motion_;
};

// |input| unchanged for a while: a stack responds to its square, which reversals do not change.
Mask RunRegimes::drive_constant() const {
  double level = kInfinity, since = 0.0;
  return mask_where([&](std::size_t i) {
    const double u = std::abs(run_.rows[i].input);
    if (std::abs(u - level) > kConstantShare * evidence_.u_max) level = u, since = run_.rows[i].time;
    return run_.rows[i].time - since >= kConstantFor;
  });
}

Mask RunRegimes::stuck() const {
  const double rest =
      std::max(kRestingStds * measured_motion_.speed_noise, kRestingShare * measured_motion_.usual_top_speed);
  Mask mask = mask_where([&](std::size_t i) {
    return std::abs(measured_motion_.v[i]) <= rest && std::abs(model_motion_.v[i]) > 2.0 * rest;
  });
  const double shortest = std::max(kStuckShortest, 2.0 * measured_motion_.half_width);
  for (std::size_t from = 0, to = 0; from < mask.size(); from = to) {
    for (to = from + 1; to < mask.size() && mask[to] == mask[from];) ++to;
    const double lasted =
        (to < mask.size() ? run_.rows[to].time : run_.rows.back().time) - run_.rows[from].time;
    if (mask[from] && lasted < shortest) std::fill(mask.begin() + from, mask.begin() + to, false);
  }
  return mask;
}

std::size_t RunRegimes::puncture() const {
  std::vector<double> deepening;
  for (const double v : measured_motion_.v)
    if (v > moving()) deepening.push_back(v);
  const std::size_t none = run_.rows.size();
  if (deepening.empty()) return none;
  const double usual = quantile(deepening, 0.5);
  std::size_t fastest = none;
  for (std::size_t i = 0; i < none; ++i) {
    const double v = measured_motion_.v[i];
    if (v < kSudden * usual) continue;
    const std::size_t from = row_at(run_.rows[i].time - kFallTime),
                      to = row_at(run_.rows[i].time + kFallTime);
    const double fall = measured_motion_.x[to] - measured_motion_.x[from];
    const double model_fall = std::abs(model_motion_.x[to] - model_motion_.x[from]);
    if (fall - model_fall < kFall * (evidence_.x_high - evidence_.x_low)) continue;
    if (fastest == none || v > measured_motion_.v[fastest]) fastest = i;
  }
  return fastest;
}

// Sums over the rows of one regime, weighted by time.
struct RegimeSum {
  double time = 0.0, excess = 0.0, before = 0.0, after = 0.0;
};

class RegimeSums {
 public:
  void add(const std::string& name, const EvidenceRun& run, const Mask& mask, const double* before,
           const double* after, double noise) {
    auto [place, fresh] = order_.try_emplace(name, tallies_.size());
    if (fresh) tallies_.push_back({name, {}});
    RegimeSum& tally = tallies_[place->second].second;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!mask[i]) continue;
      const double span = run.rows[i].span, square = before[i] * before[i];
      tally.time += span;
      tally.excess += span * (square - noise * noise);
      tally.before += span * square;
      tally.after += span * after[i] * after[i];
    }
  }

  std::vector<GapRegime> shares(double time, double excess) const {
    std::vector<GapRegime> out;
    for (const auto& [name, tally] : tallies_) {
      if (tally.time <= 0.0) continue;
      out.push_back(
          {.name = name,
           .share_of_time = tally.time / time,
           .share_of_excess_error = excess > 0.0 ? std::clamp(tally.excess / excess, 0.0, 1.0) : 0.0,
           .rmse_before = kMm * std::sqrt(tally.before / tally.time),
           .rmse_after = kMm * std::sqrt(tally.after / tally.time)});
    }
    return out;
  }

 private:
  std::map<std::string, std::size_t> order_;
  std::vector<std::pair<std::string, RegimeSum>> tallies_;
};

struct Named {
  std::string name;
  Mask mask;
};

// Thirds of |input| and of the measured range; none where they are constant.
void add_thirds(std::vector<Named>& out, const RunRegimes& s, const Evidence& evidence, double u_low,
                Drive drive) {
  const std::string quantity = drive == Drive::Force ? "force" : "voltage";
  const double u_third = (evidence.u_max - u_low) / 3.0, x_third = (evidence.x_high - evidence.x_low) / 3.0;
  if (u_third > 0.0) {
    out.push_back({"low_" + quantity, s.drive_between(0.0, u_low + u_third)});
    out.push_back({"high_" + quantity, s.drive_between(evidence.u_max - u_third, kInfinity)});
  }
  if (x_third > 0.0) {
    out.push_back({"shallow", s.measured_between(-kInfinity, evidence.x_low + x_third)});
    out.push_back({"deep", s.measured_between(evidence.x_high - x_third, kInfinity)});
  }
}

std::vector<Named> regimes_of(const EvidenceRun& run, const RunRegimes& s, const Evidence& evidence,
                              double u_low, Drive drive) {
  const std::size_t rows = run.rows.size();
  std::vector<Named> out{{"after_reversal", s.after_reversal()},
                         {"rising", s.rising()},
                         {"falling", s.falling()},
                         {"holding", s.holding()},
                         {"stuck", s.stuck()}};
  add_thirds(out, s, evidence, u_low, drive);
  out.push_back({"early", s.between_times(0.0, 0.25)});
  out.push_back({"late", s.between_times(0.75, kInfinity)});
  if (const std::size_t puncture = s.puncture(); puncture < rows) {
    out.push_back({"before_puncture", s.from_row_to(0, puncture)});
    out.push_back({"after_puncture", s.from_row_to(puncture, rows)});
  }
  out.push_back({"run:" + run.name, Mask(rows, true)});
  return out;
}

double least_input(const Evidence& evidence) {
  double least = evidence.u_max;
  for (const EvidenceRun& run : evidence.runs)
    for (const Row& row : run.rows) least = std::min(least, std::abs(row.input));
  return least;
}

double lift(const GapRegime& regime) {
  return regime.share_of_excess_error / regime.share_of_time;
}

int rank(const GapRegime& regime) {
  if (std::abs(lift(regime) - 1.0) < kUnremarkable) return 2;
  return regime.share_of_time < kShortTime || regime.share_of_excess_error < kSlightError ? 1 : 0;
}

std::vector<double> part_of(const std::vector<double>& all, std::size_t from, std::size_t count) {
  assert(from + count <= all.size());
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from);
  return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace

std::vector<GapRegime> localize_residual(const Evidence& evidence, const std::vector<double>& before,
                                         const std::vector<double>& after, Drive drive) {
  assert(before.size() == after.size());
  RegimeSums tallies;
  double time = 0.0, excess = 0.0;
  const double u_low = least_input(evidence), noise = evidence.noise;
  std::size_t from = 0;
  for (const EvidenceRun& run : evidence.runs) {
    const RunRegimes situation(run, part_of(before, from, run.rows.size()), evidence, drive);
    for (const Named& regime : regimes_of(run, situation, evidence, u_low, drive))
      tallies.add(regime.name, run, regime.mask, &before[from], &after[from], noise);
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      time += run.rows[i].span;
      excess += run.rows[i].span * (before[from + i] * before[from + i] - noise * noise);
    }
    from += run.rows.size();
  }
  assert(from == before.size());
  std::vector<GapRegime> out = tallies.shares(time, excess);
  std::stable_sort(out.begin(), out.end(), [](const GapRegime& a, const GapRegime& b) {
    return rank(a) != rank(b) ? rank(a) < rank(b) : lift(a) > lift(b);
  });
  return out;
}

MainRegimes main_regime(const Evidence& evidence, const std::vector<double>& before, Drive drive) {
  MainRegimes out{.names = {"after_reversal", "stuck", "rising", "falling", "holding"}, .of_row = {}};
  std::size_t from = 0;
  for (const EvidenceRun& run : evidence.runs) {
    const RunRegimes s(run, part_of(before, from, run.rows.size()), evidence, drive);
    const Mask masks[] = {s.after_reversal(), s.stuck(), s.rising(), s.falling()};
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      std::uint8_t main = 0;
      while (main < std::size(masks) && !masks[main][i]) ++main;
      out.of_row.push_back(main);
    }
    from += run.rows.size();
  }
  return out;
}

}  // namespace biopsy::sim::gap
