#include "robot/report/plot/svg_bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "robot/common/number_text.hpp"
#include "robot/common/sanitize_text.hpp"
#include "robot/report/plot/svg_chart.hpp"

namespace biopsy::report {
namespace {

// Layout in the same user units as svg_chart.
constexpr double kBarsWidth = 1000, kNames = 290, kValues = 80, kBarsTop = 26, kBar = 12, kGap = 6;
constexpr double kPlot = kBarsWidth - kNames - kValues;
constexpr std::size_t kLongestName = 34;
constexpr double kBarLetter = 8.2;

std::string shortened(const std::string& text) {
  if (text.size() <= kLongestName) return text;
  std::size_t end = kLongestName;
  while (end > 0 && (text[end] & 0xC0) == 0x80) --end;  // not in the middle of a letter
  return text.substr(0, end) + "…";
}

double length(const BarChart& chart, double value) {
  if (!std::isfinite(value)) return 0;
  return kPlot * std::clamp(value / std::max(chart.x_high, 1e-12), 0.0, 1.0);
}

std::string legend(const BarChart& chart) {
  std::string svg;
  double x = kNames;
  for (const BarSeries& series : chart.series) {
    svg += fmt::format(R"(<rect x="{:.1f}" y="4" width="20" height="13" fill="{}"/>)", x, series.colour) +
           fmt::format(R"(<text x="{:.1f}" y="16">{}</text>)", x + 26, escaped(series.name)) + "\n";
    x += 26 + kBarLetter * static_cast<double>(series.name.size()) + 24;
  }
  return svg;
}

std::string row(const BarChart& chart, const BarRow& bars, double top) {
  const double height = kBar * static_cast<double>(chart.series.size());
  std::string svg = fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{}</text>)", kNames - 9,
                                top + height / 2 + 5, escaped(shortened(plain(bars.name))));
  for (std::size_t i = 0; i < std::min(chart.series.size(), bars.values.size()); ++i) {
    const double y = top + kBar * static_cast<double>(i), width = length(chart, bars.values[i]);
    svg += fmt::format(
        R"(<rect class="bar-of-chart" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>)",
        kNames, y, width, kBar - 1, chart.series[i].colour);
    svg += fmt::format(R"(<text x="{:.1f}" y="{:.1f}" font-size="12.5">{}</text>)", kNames + width + 5,
                       y + kBar - 2, fixed(bars.values[i], 0, escaped(chart.unit)));
  }
  return svg + "\n";
}

std::string axis(const BarChart& chart, double bottom) {
  std::string svg;
  for (const double x : round_ticks(0, chart.x_high, 8)) {
    const double at = kNames + length(chart, x);
    svg += fmt::format(R"(<path d="M{0:.1f} {1:.1f}V{2:.1f}" stroke="#d3d8dc"/>)", at, kBarsTop, bottom) +
           fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)", at, bottom + 18, x);
  }
  return svg +
         fmt::format(R"(<path d="M{0:.1f} {1:.1f}V{2:.1f}" stroke="#5d6a75"/>)", kNames, kBarsTop, bottom) +
         fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", kNames + kPlot / 2,
                     bottom + 38, escaped(chart.x_title)) +
         "\n";
}

}  // namespace

std::string render(const BarChart& chart) {
  const double pitch = kBar * static_cast<double>(chart.series.size()) + kGap;
  const double bottom = kBarsTop + kGap + pitch * static_cast<double>(chart.rows.size());
  std::string svg =
      fmt::format(
          R"(<svg xmlns="http://www.w3.org/2000/svg" class="chart" role="img" viewBox="0 0 {:.0f} {:.0f}" )"
          R"(font-family="'DejaVu Sans',Arial,sans-serif" font-size="15" fill="#1d262e">)",
          kBarsWidth, bottom + 46) +
      "<title>" + escaped(chart.title) + "</title><desc>" + escaped(chart.description) + "</desc>\n" +
      fmt::format(R"(<rect width="{:.0f}" height="{:.0f}" fill="#ffffff"/>)", kBarsWidth, bottom + 46) +
      axis(chart, bottom) + legend(chart);
  for (std::size_t i = 0; i < chart.rows.size(); ++i)
    svg += row(chart, chart.rows[i], kBarsTop + kGap + pitch * static_cast<double>(i));
  return svg + "</svg>";
}

}  // namespace biopsy::report
