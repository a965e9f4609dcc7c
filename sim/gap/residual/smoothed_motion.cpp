#include "sim/gap/residual/smoothed_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "robot/common/statistics.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();  // s
constexpr double kSmoothTurn = 0.3;                                 // s, longer is a rest
constexpr double kSpeedNoise = 0.05;                                // of the usual top speed
constexpr double kWidest = 0.25, kWidestShare = 1.0 / 20;           // s, of the run
constexpr std::size_t kFewestRows = 2;                              // to either side
constexpr double kMovingStds = 3.0, kMovingShare = 0.05;  // of the speed's noise, of the usual top speed

// Running sums for straight lines. Extended precision: differences of them over ten rows out of a million.
struct Sums {
  long double n = 0, t = 0, y = 0, tt = 0, ty = 0;
  void add(long double time, long double value) {
    n += 1, t += time, y += value, tt += time * time, ty += time * value;
  }
  Sums since(const Sums& earlier) const {
    return {n - earlier.n, t - earlier.t, y - earlier.y, tt - earlier.tt, ty - earlier.ty};
  }
};

std::vector<Sums> running_sums(const EvidenceRun& run, const std::vector<double>& readings) {
  std::vector<Sums> sums(1);
  sums.reserve(run.rows.size() + 1);
  const double middle = run.rows[run.rows.size() / 2].time;
  for (std::size_t i = 0; i < run.rows.size(); ++i) {
    sums.push_back(sums.back());
    sums.back().add(run.rows[i].time - middle, readings[i]);
  }
  return sums;
}

// Time of the reversal between two rows of clearly opposite speed: the middle of a smooth turn, where noise
// crosses zero many times; after a longer rest the start of the new motion.
double turning_time(const EvidenceRun& run, const std::vector<double>& v, std::size_t moved,
                    std::size_t moves) {
  const double from = run.rows[moved].time, to = run.rows[moves].time;
  if (to - from <= kSmoothTurn) return 0.5 * (from + to);
  std::size_t set_off = moves;
  while (set_off > moved && v[set_off - 1] * v[moves] > 0.0) --set_off;
  return run.rows[set_off].time;
}

}  // namespace

double duration(const EvidenceRun& run) {
  return run.rows.back().time + run.rows.back().span - run.rows.front().time;
}

double moving_threshold(const SmoothedMotion& motion) {
  return std::max(kMovingStds * motion.speed_noise, kMovingShare * motion.usual_top_speed);
}

SmoothedMotion smoothed_motion_within(const EvidenceRun& run, const std::vector<double>& readings,
                                      double noise, double half_width) {
  assert(readings.size() == run.rows.size() && !readings.empty());
  const std::size_t rows = readings.size();
  const std::vector<Sums> sums = running_sums(run, readings);
  const double middle = run.rows[rows / 2].time;
  SmoothedMotion out{.x = readings, .v = std::vector<double>(rows, 0.0), .half_width = half_width};
  std::vector<double> speeds, noises;
  for (std::size_t i = 0, from = 0, to = 0; i < rows; ++i) {
    const double now = run.rows[i].time;
    while (run.rows[from].time < now - half_width) ++from;
    while (to < rows && run.rows[to].time <= now + half_width) ++to;
    const std::size_t first = std::min(from, i > kFewestRows ? i - kFewestRows : 0);
    const Sums s = sums[std::max(to, std::min(rows, i + kFewestRows + 1))].since(sums[first]);
    const long double spread = s.tt - s.t * s.t / s.n;
    if (s.n < 2 || spread <= 0.0L) continue;
    const long double slope = (s.ty - s.t * s.y / s.n) / spread;
    out.v[i] = static_cast<double>(slope);
    out.x[i] = static_cast<double>(s.y / s.n + slope * (now - middle - s.t / s.n));
    noises.push_back(noise / std::sqrt(static_cast<double>(spread)));
    speeds.push_back(std::abs(out.v[i]));
  }
  if (speeds.empty()) return out;
  out.speed_noise = quantile(std::move(noises), 0.5);
  out.usual_top_speed = quantile(std::move(speeds), 0.95);
  return out;
}

SmoothedMotion smoothed_motion(const EvidenceRun& run, const std::vector<double>& readings, double noise) {
  const double widest = std::min(kWidest, kWidestShare * duration(run));
  double half_width = duration(run) / static_cast<double>(run.rows.size()) * static_cast<double>(kFewestRows);
  for (;; half_width *= 1.5) {
    SmoothedMotion motion = smoothed_motion_within(run, readings, noise, std::min(half_width, widest));
    if (half_width >= widest || motion.speed_noise <= kSpeedNoise * motion.usual_top_speed) return motion;
  }
}

std::vector<double> since_reversal(const EvidenceRun& run, const SmoothedMotion& measured, Drive drive) {
  const bool force = drive == Drive::Force;
  const double threshold = force ? moving_threshold(measured) : 0.0;
  const std::size_t rows = run.rows.size();
  const auto signal = [&](std::size_t i) { return force ? measured.v[i] : run.rows[i].input; };
  std::vector<double> out(rows, kNever);
  std::size_t moved = rows;  // the last row of a clear sign
  double turned = kNever;
  for (std::size_t i = 0; i < rows; ++i) {
    if (std::abs(signal(i)) > threshold) {
      if (moved < rows && signal(moved) * signal(i) < 0.0) {
        turned = force ? turning_time(run, measured.v, moved, i) : run.rows[i].time;
        for (std::size_t k = moved; k < i; ++k)
          if (run.rows[k].time >= turned) out[k] = run.rows[k].time - turned;
      }
      moved = i;
    }
    if (std::isfinite(turned)) out[i] = run.rows[i].time - turned;
  }
  return out;
}

}  // namespace biopsy::sim::gap
