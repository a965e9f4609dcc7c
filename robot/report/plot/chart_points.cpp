#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robot/report/plot/figure_svg.hpp"
#include "robot/report/plot/svg_chart.hpp"

namespace biopsy::report {
namespace {

// First, lowest, highest and last of [from, to), each once, in the order in which they came.
void append_column(const std::vector<Vertex>& points, std::size_t from, std::size_t to,
                   std::vector<Vertex>& kept) {
  const auto begin = points.begin() + static_cast<std::ptrdiff_t>(from);
  const auto end = points.begin() + static_cast<std::ptrdiff_t>(to);
  const auto lower = [](const Vertex& a, const Vertex& b) { return a.y < b.y; };
  const auto [low, high] = std::minmax_element(begin, end, lower);
  std::ptrdiff_t chosen[] = {0, low - begin, high - begin, end - begin - 1};
  std::sort(std::begin(chosen), std::end(chosen));
  const auto* last = std::unique(std::begin(chosen), std::end(chosen));
  for (const auto* offset = std::begin(chosen); offset != last; ++offset) kept.push_back(begin[*offset]);
}

}  // namespace

std::vector<Vertex> decimated(const std::vector<Vertex>& points, double x_low, double x_high, int columns) {
  const double columns_per_x = columns / std::max(x_high - x_low, 1e-12);
  const auto column = [&](const Vertex& v) { return std::floor((v.x - x_low) * columns_per_x); };
  std::vector<Vertex> kept;
  for (std::size_t from = 0, to = 0; from < points.size(); from = to) {
    for (to = from + 1; to < points.size() && column(points[to]) == column(points[from]);) ++to;
    append_column(points, from, to, kept);
  }
  return kept;
}

ChartPanel autoscaled_panel(std::string y_title, double height_px, std::vector<ChartLine> lines) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const ChartLine& line : lines)
    for (const Vertex& v : line.points)
      if (std::isfinite(v.y)) low = std::min(low, v.y), high = std::max(high, v.y);
  ChartPanel panel{.y_title = std::move(y_title), .height_px = height_px, .lines = std::move(lines)};
  if (!(high >= low)) return panel;
  const double room = high > low ? 0.06 * (high - low) : std::max(0.1 * std::abs(high), 1e-3);
  panel.y_low = low - room;
  panel.y_high = high + room;
  return panel;
}

std::vector<double> round_ticks(double low, double high, int count) {
  if (!(high > low)) return {low};
  const double rough = (high - low) / std::max(count, 1);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * 0.999) {
      step = factor * power;
      break;
    }
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-9), last = std::floor(high / step + 1e-9);
  for (double n = first; n <= last; ++n) ticks.push_back(n * step + 0.0);
  return ticks;
}

LogarithmicTicks logarithmic_ticks(double low, double high) {
  LogarithmicTicks ticks;
  if (!(low > 0.0) || !(high > low) || !std::isfinite(high)) return ticks;
  const bool few = high / low < 150.0;  // room for a number at 2 and 5 as well
  const double first = std::floor(std::log10(low)), last = std::floor(std::log10(high * (1.0 + 1e-9)));
  for (double decade = first; decade <= last; ++decade)
    for (int factor = 1; factor <= 9; ++factor) {
      const double tick = factor * std::pow(10.0, decade);
      if (tick < low * (1.0 - 1e-9) || tick > high * (1.0 + 1e-9)) continue;
      ticks.all.push_back(tick);
      if (factor == 1 || (few && (factor == 2 || factor == 5))) ticks.named.push_back(tick);
    }
  return ticks;
}

}  // namespace biopsy::report
