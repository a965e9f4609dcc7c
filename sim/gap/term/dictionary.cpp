#include "sim/gap/term/dictionary.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/gap/residual/predict.hpp"
#include "sim/gap/residual/smoothed_motion.hpp"
#include "sim/plant/circuit.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr std::array kDictionaryTimes{0.05, 0.2, 0.8, 3.0, 12.0};  // s
constexpr std::array kDictionaryProducts{
    "a + b x + c x^2 + d x^3 + e x^4 + f x^5",
    "a v + b v^2 + c v^3 + d |v| v + e |v|",
    "a x v + b x^2 v + c x^3 v + d x^4 v",
    "a x |v| v + b x v^2 + c x v^3 + d x^2 |v| v",
    "a sign(v) + b x sign(v) + c x^2 sign(v) + d |u| sign(v) + e u^2 sign(v)",
    "a u + b u^2 + c u^3 + d |u| u + e |u|^3 + f u^4",
    "a u^5 + b sign(u) + c u |v|",
    "a x u + b x^2 u + c x^3 u + d x^4 u",
    "a x u^2 + b v u + c v u^2 + d v |u|",
    "a |u| + b x |u|"};
constexpr double kSameDirection = 1e-6;  // sine of the angle between two products' values
constexpr double kStillSpeed = 3.0;      // of the noise of the speed
constexpr const char* kWithMemory = "a q + b q^2";
constexpr const char* kWithExponent = "a sign(v) |v|^n";
constexpr double kDictionaryExponent = 0.5;
constexpr const char* kWithPeriod = "a sin(kx) + b cos(kx)";
// Periods in the travel: fewer are a polynomial; half a step is 0.4 rad at the ends, which a fit finds.
constexpr double kFewestPeriods = 1.25, kMostPeriods = 6.0, kPeriodStep = 0.25;

// Fills the rows of one run from its states.
void add_motion_row(MotionRows& out, const EvidenceRun& run, std::size_t i, const TermPoint& point) {
  out.points.push_back(point);
  out.times.push_back(run.rows[i].span);
  out.begins.push_back(i == 0 ||
                       std::ranges::any_of(run.windows, [&](const WindowStart& w) { return w.row == i; }));
}

double drive_of(const PlantModel& model, const PlantState& state, const Row& row) {
  if (model.baseline.drive == Drive::Force) return row.input;
  return acting_voltage(model, {state.u_i, state.u_o, state.screened});
}

}  // namespace

std::vector<DictionaryEntry> dictionary(double travel) {
  std::vector<DictionaryEntry> out;
  for (const char* products : kDictionaryProducts)
    for (const TermPart& part : parse_expression(products, "")) out.push_back({.powers = part.powers});
  for (const double time : kDictionaryTimes)
    for (const TermPart& part : parse_expression(kWithMemory, ""))
      out.push_back({.powers = part.powers, .memory_time = time});
  for (const TermPart& part : parse_expression(kWithExponent, ""))
    out.push_back({.powers = part.powers, .exponent = kDictionaryExponent});
  if (travel > 0.0)
    for (double periods = kFewestPeriods; periods <= kMostPeriods; periods += kPeriodStep)
      for (const TermPart& part : parse_expression(kWithPeriod, ""))
        out.push_back({.powers = part.powers, .period = travel / periods});
  return out;
}

TermRanges MotionRows::ranges() const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const TermRange none{kFar, -kFar};
  TermRanges out{none, none, none, none};
  const auto widen = [](TermRange& range, double value) {
    range.low = std::min(range.low, value), range.high = std::max(range.high, value);
  };
  for (const TermPoint& point : points) {
    widen(out.x, point.x);
    widen(out.v, point.v);
    widen(out.drive, point.drive);
  }
  const double travel = out.x.high - out.x.low;
  out.memory = {-travel, travel};
  return out;
}

MotionRows measured_motion(const PlantModel& model, const Evidence& evidence) {
  MotionRows out;
  for (const EvidenceRun& run : evidence.runs) {
    std::vector<double> readings;
    for (const Row& row : run.rows) readings.push_back(row.measured);
    const SmoothedMotion motion = smoothed_motion(run, readings, evidence.noise);
    const double moves = kStillSpeed * motion.speed_noise;
    std::size_t i = 0;
    visit_rows(model, evidence, run, run.rows.size(), [&](const PlantModel& now, const PlantState& state) {
      const double v = std::abs(motion.v[i]) > moves ? motion.v[i] : 0.0;
      add_motion_row(out, run, i, {.x = motion.x[i], .v = v, .drive = drive_of(now, state, run.rows[i])});
      ++i;
    });
  }
  return out;
}

MotionRows simulated_motion(const PlantModel& model, const Evidence& evidence) {
  MotionRows out;
  for (const EvidenceRun& run : evidence.runs) {
    std::size_t i = 0;
    visit_rows(model, evidence, run, run.rows.size(), [&](const PlantModel& now, const PlantState& state) {
      add_motion_row(out, run, i,
                     {.x = state.motion.x, .v = state.motion.v, .drive = drive_of(now, state, run.rows[i])});
      ++i;
    });
  }
  return out;
}

std::vector<double> memory_of(const MotionRows& motion, double time) {
  std::vector<double> out;
  double memory = 0.0;
  for (std::size_t i = 0; i < motion.points.size(); ++i) {
    if (motion.begins[i]) memory = 0.0;
    out.push_back(memory);
    if (i + 1 == motion.points.size()) break;
    const double fading = std::exp(-motion.times[i] / time);
    memory = fading * memory + std::sqrt(fading) * (motion.points[i + 1].x - motion.points[i].x);
  }
  return out;
}

std::vector<double> values_of(const DictionaryEntry& entry, const MotionRows& motion) {
  const std::vector<double> memory =
      entry.memory_time > 0.0 ? memory_of(motion, entry.memory_time) : std::vector<double>{};
  const TermRange speeds = motion.ranges().v;
  const double slow = kSlowShare * std::max(std::abs(speeds.low), std::abs(speeds.high));
  std::vector<double> out;
  for (std::size_t i = 0; i < motion.points.size(); ++i) {
    TermPoint point = motion.points[i];
    if (!memory.empty()) point.memory = memory[i];
    point.slow = slow;
    point.exponent = entry.exponent;
    point.phase = wave_number(entry.period) * point.x;
    out.push_back(product_at(entry.powers, point));
  }
  return out;
}

std::vector<DictionaryEntry> distinct_entries(const MotionRows& motion) {
  std::vector<DictionaryEntry> out;
  std::vector<Eigen::VectorXd> directions;
  const TermRange places = motion.ranges().x;
  for (const DictionaryEntry& entry : dictionary(places.high - places.low)) {
    const std::vector<double> values = values_of(entry, motion);
    const Eigen::VectorXd direction =
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()))
            .normalized();
    if (std::ranges::any_of(directions, [&](const Eigen::VectorXd& before) {
          return (direction - direction.dot(before) * before).norm() < kSameDirection;
        }))
      continue;
    out.push_back(entry);
    directions.push_back(direction);
  }
  return out;
}

}  // namespace biopsy::sim::gap
