#include "robot/report/plot/svg_bars.hpp"

#include <algorithm>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/plot/svg_chart.hpp"

namespace biopsy::report {
namespace {

// Layout in the same user units as svg_chart.
constexpr double kBarsWidth = 1000, kNames = 290, kValues = 80, kBarsTop = 26, kBar = 12, kGap = 6;
constexpr double kPlot = kBarsWidth - kNames - kValues;
constexpr std::size_t kLongestName = 34;
constexpr double kBarLetter = 8.2;

double length(const BarChart& chart, double value) {
  if (!std::isfinite(value)) return 0;
  return kPlot * std::clamp(value / std::max(chart.x_high, 1e-12), 0.0, 1.0);
}

void draw_legend(SvgWriter& svg, const BarChart& chart) {
  double x = kNames;
  for (const BarSeries& series : chart.series) {
    svg.rect({x, 4, 20, 13}, fmt::format(R"(fill="{}")", series.colour));
    svg.text({x + 26, 16}, series.name);
    x += 26 + kBarLetter * static_cast<double>(display_width(series.name)) + 24;
  }
}

void draw_row(SvgWriter& svg, const BarChart& chart, const BarRow& bars, double top) {
  const double height = kBar * static_cast<double>(chart.series.size());
  svg.text({kNames - 9, top + height / 2 + 5}, shortened(plain(bars.name), kLongestName),
           R"(text-anchor="end")");
  for (std::size_t i = 0; i < std::min(chart.series.size(), bars.values.size()); ++i) {
    const double y = top + kBar * static_cast<double>(i), width = length(chart, bars.values[i]);
    svg.put(R"(<rect class="bar-of-chart" x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>)",
            kNames, y, width, kBar - 1, chart.series[i].colour);
    svg.text({kNames + width + 5, y + kBar - 2}, fixed(bars.values[i], 0, chart.unit), R"(font-size="12.5")");
  }
}

void draw_axis(SvgWriter& svg, const BarChart& chart, double bottom) {
  const PlotArea plot{kNames, kBarsTop, kPlot, bottom - kBarsTop};
  for (const double x : round_ticks(0, chart.x_high, 8)) {
    svg.x_grid(plot, kNames + length(chart, x));
    svg.x_number(kNames + length(chart, x), bottom + 18, x);
  }
  svg.path(SvgWriter::line(kNames, kBarsTop, 'V', bottom), R"(stroke="#5d6a75")");
  svg.text({kNames + kPlot / 2, bottom + 38}, chart.x_title, R"(text-anchor="middle")");
}

}  // namespace

std::string render(const BarChart& chart) {
  const double pitch = kBar * static_cast<double>(chart.series.size()) + kGap;
  const double bottom = kBarsTop + kGap + pitch * static_cast<double>(chart.rows.size());
  SvgWriter svg({.css_class = "chart",
                 .width = kBarsWidth,
                 .height = bottom + 46,
                 .title = chart.title,
                 .description = chart.description});
  draw_axis(svg, chart, bottom);
  draw_legend(svg, chart);
  for (std::size_t i = 0; i < chart.rows.size(); ++i)
    draw_row(svg, chart, chart.rows[i], kBarsTop + kGap + pitch * static_cast<double>(i));
  return svg.finished();
}

}  // namespace biopsy::report
