#include <algorithm>
#include <cmath>

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

}  // namespace biopsy::report
