#include "sim/paper/figures/loop_scores.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace biopsy::sim::paper {
namespace {

// Root mean square of the error where chosen(tick).
template <class Chosen>
double rmse_where(const Course& course, Chosen&& chosen) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < course.time.size(); ++k) {
    if (!chosen(k)) continue;
    const double error = course.target[k] - course.plate_a[k];
    sum += error * error;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : std::numeric_limits<double>::quiet_NaN();
}

struct Ticks {
  std::size_t first, last;
};

Ticks ticks(const Course& course, double from, double to) {
  const auto at = [&](double time) {
    return static_cast<std::size_t>(std::lower_bound(course.time.begin(), course.time.end(), time - 1e-9) -
                                    course.time.begin());
  };
  return {at(from), at(to)};
}

}  // namespace

std::vector<bool> settled(const Course& course, double settling) {
  std::vector<bool> out(course.time.size());
  double since = 0.0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (k > 0 && std::abs(course.target[k] - course.target[k - 1]) > kJump) since = course.time[k];
    out[k] = course.time[k] - since >= settling;
  }
  return out;
}

double rmse(const Course& course) {
  return rmse_where(course, [](std::size_t) { return true; });
}

double rmse_settled(const Course& course, double settling) {
  const std::vector<bool> chosen = settled(course, settling);
  return rmse_where(course, [&](std::size_t k) { return chosen[k]; });
}

double rmse_between(const Course& course, double low, double high) {
  return rmse_where(course,
                    [&](std::size_t k) { return course.target[k] >= low && course.target[k] < high; });
}

std::vector<Edge> edges(const Course& course) {
  std::vector<Edge> out;
  for (std::size_t k = 1; k < course.time.size(); ++k) {
    if (std::abs(course.target[k] - course.target[k - 1]) <= kJump) continue;
    if (!out.empty()) out.back().until = k;
    out.push_back({k, course.time.size(), course.target[k - 1], course.target[k]});
  }
  return out;
}

double beyond_target(const Course& course, const Edge& edge) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = edge.at; k < edge.until; ++k)
    most = std::max(most, (course.plate_a[k] - edge.to) * (edge.rises() ? 1.0 : -1.0));
  return most;
}

double travel_time(const Course& course, const Edge& edge) {
  std::size_t k = edge.at;
  while (k < edge.until && (course.plate_a[k] - edge.from) / (edge.to - edge.from) < 0.9) ++k;
  return static_cast<double>(k - edge.at) * (course.time[1] - course.time[0]);
}

double mean_travel(const Course& course, bool rising) {
  double sum = 0.0, count = 0.0;
  for (const Edge& edge : edges(course)) {
    if (edge.rises() != rising) continue;
    sum += travel_time(course, edge);
    count += 1.0;
  }
  return sum / count;
}

double visible_lag(const Course& course) {
  return (mean_travel(course, false) - mean_travel(course, true)) / (kLineShare * course.time.back()) - 1.0;
}

double overshoot_percent(const Course& course) {
  double most = 0.0;
  for (const Edge& edge : edges(course))
    if (edge.rises()) most = std::max(most, 100.0 * beyond_target(course, edge) / edge.to);
  return most;
}

double undershoot_percent(const Course& course) {
  double most = 0.0;
  for (const Edge& edge : edges(course))
    if (!edge.rises()) most = std::max(most, 100.0 * beyond_target(course, edge) / (edge.from - edge.to));
  return most;
}

Transfer transfer(const Course& course, double frequency, double from) {
  const double periods = std::floor((course.time.back() + 1e-3 - from) * frequency + 1e-6);
  const Ticks within = ticks(course, from, from + periods / frequency);
  std::complex<double> input, output;
  for (std::size_t k = within.first; k < within.last; ++k) {
    const auto turn = std::polar(1.0, -2.0 * std::numbers::pi * frequency * course.time[k]);
    input += course.target[k] * turn;
    output += course.plate_a[k] * turn;
  }
  const std::complex<double> ratio = output / input;
  return {std::abs(ratio), -std::arg(ratio) * 180.0 / std::numbers::pi};
}

Span span(const Course& course, const std::vector<double>& values, double from, double to) {
  const Ticks within = ticks(course, from, to);
  const auto [low, high] = std::minmax_element(values.begin() + static_cast<std::ptrdiff_t>(within.first),
                                               values.begin() + static_cast<std::ptrdiff_t>(within.last));
  return {*low, *high};
}

double mean_between(const Course& course, const std::vector<double>& values, double from, double to) {
  const Ticks within = ticks(course, from, to);
  double sum = 0.0;
  for (std::size_t k = within.first; k < within.last; ++k) sum += values[k];
  return sum / static_cast<double>(within.last - within.first);
}

}  // namespace biopsy::sim::paper
