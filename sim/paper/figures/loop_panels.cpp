#include "sim/paper/figures/loop_panels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace biopsy::sim::paper {
namespace {

constexpr std::size_t kPoints = 1000;
constexpr double kAir = 0.06;  // of the height, above and below the curves

FigurePanel time_panel(std::string title, std::string y_title, TimeSpan part) {
  FigurePanel panel;
  panel.title = std::move(title);
  panel.x_title = "time (s)";
  panel.y_title = std::move(y_title);
  panel.x_low = part.from;
  panel.x_high = part.to;
  return panel;
}

struct Heights {
  double low, high;
};

Heights heights(const FigurePanel& panel, Heights within) {
  for (const FigureCurve& curve : panel.curves)
    for (const double y : curve.y) {
      if (!std::isfinite(y)) continue;
      within.low = std::min(within.low, y);
      within.high = std::max(within.high, y);
    }
  return within;
}

}  // namespace

FigureCurve drawn(std::string name, const Course& course, const std::vector<double>& values, TimeSpan part) {
  const auto first = std::lower_bound(course.time.begin(), course.time.end(), part.from - 1e-9);
  const auto last = std::lower_bound(first, course.time.end(), part.to + 1e-9);
  const auto begin = static_cast<std::size_t>(first - course.time.begin());
  const auto end = static_cast<std::size_t>(last - course.time.begin());
  const std::size_t every = std::max<std::size_t>(1, (end - begin) / kPoints);
  FigureCurve curve;
  curve.name = std::move(name);
  for (std::size_t k = begin; k < end; k += every) {
    curve.x.push_back(course.time[k]);
    curve.y.push_back(values[k]);
  }
  return curve;
}

FigurePanel displacement_panel(std::string title, const Course& course, TimeSpan part) {
  FigurePanel panel = time_panel(std::move(title), "displacement (mm)", part);
  panel.curves = {drawn("target", course, course.target, part),
                  drawn("plate A", course, course.plate_a, part)};
  panel.curves.front().dashed = true;
  fit_height(panel);
  return panel;
}

FigurePanel voltage_panel(std::string title, const Course& course, TimeSpan part) {
  FigurePanel panel = time_panel(std::move(title), "amplitude (kV)", part);
  panel.curves = {drawn("", course, course.amplitude, part)};
  fit_height(panel);
  return panel;
}

void fit_height(FigurePanel& panel) {
  const auto [low, high] = heights(panel, {0.0, 0.0});
  const double air = kAir * std::max(high - low, 1e-3);
  panel.y_low = low < 0.0 ? low - air : 0.0;
  panel.y_high = high + air;
}

void fit_closely(FigurePanel& panel) {
  constexpr double kFar = std::numeric_limits<double>::max();
  const auto [low, high] = heights(panel, {kFar, -kFar});
  if (low > high) return;
  const double air = kAir * std::max(high - low, 1e-3);
  panel.y_low = low - air;
  panel.y_high = high + air;
}

}  // namespace biopsy::sim::paper
