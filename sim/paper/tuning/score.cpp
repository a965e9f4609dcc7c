#include "sim/paper/tuning/score.hpp"

#include <algorithm>
#include <cmath>

#include "sim/paper/feed_forward.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::tuning {
namespace {

using paper::kSineHigh, paper::kSineLow, paper::kSlowest, paper::kSquareHigh, paper::kSquareLow;

constexpr double kUp = 5.0, kDown = 12.0, kEnd = 19.0;       // s
constexpr double kBand = 0.05 * (kSquareHigh - kSquareLow);  // mm

// From the edge until plate A stays within kBand of its target. s
double settling(const paper::Course& course, const paper::Edge& edge) {
  std::size_t last = edge.at;
  for (std::size_t k = edge.at; k < edge.until; ++k)
    if (std::abs(course.plate_a[k] - edge.to) > kBand) last = k;
  return static_cast<double>(last - edge.at) * kTick_s;
}

double highest(const paper::Course& course) {
  return *std::max_element(course.amplitude.begin(), course.amplitude.end());
}

paper::Course driven(const PlantModel& stage, const Driving& driving, const paper::OfTime& target,
                     double seconds) {
  paper::LoopTask task{.target = target, .seconds = seconds, .loads = {}};
  if (driving.speed > 0.0) task.target = paper::rate_limited(target, driving.speed, seconds);
  paper::LoopSettings settings;
  settings.gains = driving.gains;
  if (driving.feed_model != nullptr)
    settings.feed = paper::feed_forward(*driving.feed_model, task.target, seconds);
  paper::Course course = follow(stage, task, settings);
  for (std::size_t k = 0; k < course.time.size(); ++k) course.target[k] = target(course.time[k]);
  return course;
}

}  // namespace

Score worse(const Score& a, const Score& b) {
  return {std::max(a.settled_rmse, b.settled_rmse), std::max(a.overshoot, b.overshoot),
          std::max(a.undershoot, b.undershoot),     std::max(a.settling, b.settling),
          std::max(a.sine_rmse, b.sine_rmse),       std::max(a.highest, b.highest)};
}

paper::Course steps(const PlantModel& stage, const Driving& driving) {
  return driven(stage, driving, paper::stair_target({0.0, kUp, kDown}, {kSquareLow, kSquareHigh, kSquareLow}),
                kEnd);
}

Score score(const PlantModel& stage, const Driving& driving) {
  const paper::Course course = steps(stage, driving);
  const double period = 1.0 / kSlowest;
  const paper::Course sine =
      driven(stage, driving, paper::sine_target(kSineLow, kSineHigh, kSlowest), period);
  Score out;
  out.settled_rmse = paper::rmse_settled(course);
  out.overshoot = paper::overshoot_percent(course);
  out.undershoot = paper::undershoot_percent(course);
  for (const paper::Edge& edge : paper::edges(course))
    out.settling = std::max(out.settling, settling(course, edge));
  out.sine_rmse = paper::rmse(sine);
  out.highest = std::max(highest(course), highest(sine));
  return out;
}

}  // namespace biopsy::sim::tuning
