#include "robot/report/plot/svg_chart.hpp"

#include <algorithm>
#include <utility>

#include "robot/common/text/text_layout.hpp"

namespace biopsy::report {
namespace {

// Layout, in SVG user units (the page scales the whole figure).
constexpr double kWidth = 1000, kLeft = 100, kTop = 8;
constexpr double kNameRow = 20;    // one row of names above the panels
constexpr double kLegendRow = 27;  // above each panel
constexpr double kStateRow = 21;
constexpr double kLetter = 8.2;  // generous width of a letter at 15 units, to keep names from touching
constexpr int kColumns = 1500;   // two per unit of the plot's width

double text_width(const std::string& text) {
  return kLetter * static_cast<double>(display_width(text));
}

std::string stroke_of(const Stroke& stroke) {
  return fmt::format(R"(stroke="{}" stroke-width="{}" stroke-dasharray="{}")", stroke.colour, stroke.width,
                     stroke.dash.empty() ? "none" : stroke.dash);
}

void draw_dot(SvgWriter& svg, Vertex at) {
  svg.put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4.5" fill="#ffffff" stroke="{}" stroke-width="1.8"/>)", at.x,
          at.y, kInk);
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) { place(); }
  std::string finished();

 private:
  double to_px(double x) const {
    return kLeft + plot_width_ * (x - chart_.x_low) / std::max(chart_.x_high - chart_.x_low, 1e-12);
  }
  static double to_px(const ChartPanel& panel, double top, double y) {
    return top + panel.height_px * (panel.y_high - y) / (panel.y_high - panel.y_low);
  }
  PlotArea area(const ChartPanel& panel, double top) const {
    return {kLeft, top, plot_width_, panel.height_px};
  }

  static double legend_height(const ChartPanel& panel);
  void place();
  double place_shade_names();
  void draw_shades(SvgWriter& svg) const;
  void draw_bands(SvgWriter& svg) const;
  void draw_markers(SvgWriter& svg) const;
  void draw_panel(SvgWriter& svg, const ChartPanel& panel, double top) const;
  void draw_grid(SvgWriter& svg, const ChartPanel& panel, double top) const;
  void draw_levels(SvgWriter& svg, const ChartPanel& panel, double top) const;
  void draw_dots(SvgWriter& svg, const ChartPanel& panel, double top) const;
  void draw_legend(SvgWriter& svg, const ChartPanel& panel, double top) const;
  void draw_states(SvgWriter& svg) const;
  void draw_x_axis(SvgWriter& svg) const;

  const Chart& chart_;
  std::vector<int> marker_rows_;
  std::vector<Vertex> shade_names_;  // where each shade's legend entry begins
  double plot_width_ = 0, names_top_ = 0, plots_top_ = 0, states_top_ = 0, plots_bottom_ = 0, height_ = 0;
  std::vector<double> tops_;  // of the panels
};

std::string Drawing::finished() {
  SvgWriter svg({.css_class = "chart",
                 .width = kWidth,
                 .height = height_,
                 .title = chart_.title,
                 .description = chart_.description});
  svg.text({kWidth - 8, kTop + 12}, chart_.note, R"(text-anchor="end" font-weight="bold")");
  draw_shades(svg);
  draw_bands(svg);
  draw_markers(svg);
  for (std::size_t i = 0; i < chart_.panels.size(); ++i) draw_panel(svg, chart_.panels[i], tops_[i]);
  draw_states(svg);
  draw_x_axis(svg);
  return svg.finished();
}

void Drawing::place() {
  double margin = 40;  // at the right: room for the longest name of a level
  for (const ChartPanel& panel : chart_.panels)
    for (const ChartLevel& level : panel.levels) margin = std::max(margin, text_width(level.name) + 18);
  plot_width_ = kWidth - kLeft - std::min(margin, 300.0);
  std::vector<double> row_ends;  // where the last name of each row of marker names ends
  for (const ChartMarker& marker : chart_.markers) {
    const double from = to_px(marker.x) - 6;
    std::size_t row = 0;
    while (row < row_ends.size() && from < row_ends[row]) ++row;
    if (row == row_ends.size()) row_ends.push_back(0);
    row_ends[row] = from + text_width(marker.name) + 24;
    marker_rows_.push_back(static_cast<int>(row));
  }
  names_top_ = kTop + (chart_.note.empty() ? 0 : kNameRow) + place_shade_names();
  plots_top_ =
      names_top_ + kNameRow * static_cast<double>(row_ends.size() + (chart_.bands.empty() ? 0 : 1)) + 4;
  double y = plots_top_;
  for (const ChartPanel& panel : chart_.panels) {
    tops_.push_back(y + legend_height(panel));
    y = tops_.back() + panel.height_px + 10;
  }
  states_top_ = y + kLegendRow;
  plots_bottom_ =
      chart_.states.empty() ? y : states_top_ + kStateRow * static_cast<double>(chart_.states.size());
  height_ = plots_bottom_ + 48;
}

double Drawing::legend_height(const ChartPanel& panel) {
  const auto named = [](const ChartLine& line) { return !line.name.empty(); };
  const bool any = !panel.dots.empty() || std::any_of(panel.lines.begin(), panel.lines.end(), named);
  return any ? kLegendRow : 8;
}

// Left to right, a new row where one is full. Returns the height of all rows.
double Drawing::place_shade_names() {
  Vertex at{kLeft, kTop + (chart_.note.empty() ? 0 : kNameRow)};
  for (const ChartShade& shade : chart_.shades) {
    const double width = 26 + text_width(shade.name) + 14;
    if (at.x > kLeft && at.x + width > kWidth) at = {kLeft, at.y + kNameRow};
    shade_names_.push_back(at);
    at.x += width;
  }
  return chart_.shades.empty() ? 0 : at.y + kNameRow - shade_names_.front().y;
}

// One path a shade: a run may turn around hundreds of times.
void Drawing::draw_shades(SvgWriter& svg) const {
  for (std::size_t i = 0; i < chart_.shades.size(); ++i) {
    const ChartShade& shade = chart_.shades[i];
    const Vertex at = shade_names_[i];
    svg.rect({at.x, at.y + 1, 20, 13}, fmt::format(R"(fill="{}" stroke="{}")", shade.colour, kFrameInk));
    svg.text({at.x + 26, at.y + 13}, shade.name);
    std::string shape;
    for (std::size_t p = 0; p < tops_.size(); ++p)
      for (const ChartSpan& span : shade.spans)
        shape +=
            fmt::format("M{0:.1f} {1:.1f}H{2:.1f}v{3:.1f}H{0:.1f}z", to_px(span.x_from), tops_[p],
                        std::max(to_px(span.x_to), to_px(span.x_from) + 0.3), chart_.panels[p].height_px);
    svg.put(R"(<path class="shade" d="{}" fill="{}"/>)", shape, shade.colour);
  }
}

// A named strip above the panels, and the same shade in every panel; legends between them stay on white.
void Drawing::draw_bands(SvgWriter& svg) const {
  for (std::size_t i = 0; i < chart_.bands.size(); ++i) {
    const ChartBand& band = chart_.bands[i];
    const double from = to_px(band.span.x_from), to = std::max(to_px(band.span.x_to), from + 0.5);
    const auto shade = [&](double top, double height) {
      svg.rect({from, top, to - from, height}, i % 2 ? R"(fill="#e1e6e9")" : R"(fill="#eef1f3")");
    };
    shade(plots_top_ - kNameRow, kNameRow);
    for (std::size_t p = 0; p < tops_.size(); ++p) shade(tops_[p], chart_.panels[p].height_px);
    if (!chart_.states.empty()) shade(states_top_, plots_bottom_ - states_top_);
    svg.text({(from + to) / 2, plots_top_ - 5},
             text_width(band.name) < to - from ? band.name : band.short_name, R"(text-anchor="middle")");
  }
}

// The line leaves out the strip with the bands' names.
void Drawing::draw_markers(SvgWriter& svg) const {
  for (std::size_t i = 0; i < chart_.markers.size(); ++i) {
    const ChartMarker& marker = chart_.markers[i];
    const double x = to_px(marker.x), y = names_top_ + kNameRow * marker_rows_[i] + 13;
    const char* colour = marker.alarm ? kAlarmInk : kInk;
    svg.path(SvgWriter::line(x, y - 3, 'V', plots_top_ - kNameRow) +
                 SvgWriter::line(x, plots_top_, 'V', plots_bottom_),
             fmt::format(R"(stroke="{}" stroke-width="{}" stroke-dasharray="{}")", colour,
                         marker.alarm ? 1.8 : 1.0, marker.alarm ? "none" : "2 3"));
    svg.path(fmt::format("M{:.1f} {:.1f}l-5 -9h10z", x, y - 1), fmt::format(R"(fill="{}")", colour));
    const bool leftwards = x + 9 + text_width(marker.name) > kWidth;
    svg.text({leftwards ? x - 9 : x + 9, y}, marker.name,
             fmt::format(R"(fill="{}" text-anchor="{}" font-weight="{}")", colour,
                         leftwards ? "end" : "start", marker.alarm ? "bold" : "normal"));
  }
}

void Drawing::draw_panel(SvgWriter& svg, const ChartPanel& panel, double top) const {
  draw_grid(svg, panel, top);
  draw_levels(svg, panel, top);
  svg.begin_clip(area(panel, top));
  for (const ChartLine& line : panel.lines) {
    std::vector<Vertex> points = decimated(line.points, chart_.x_low, chart_.x_high, kColumns);
    for (Vertex& v : points) v = {to_px(v.x), to_px(panel, top, v.y)};
    svg.polyline(points, stroke_of(line.stroke));
  }
  draw_dots(svg, panel, top);
  svg.end_clip();
  draw_legend(svg, panel, top);
}

void Drawing::draw_grid(SvgWriter& svg, const ChartPanel& panel, double top) const {
  const PlotArea plot = area(panel, top);
  for (const double y :
       round_ticks(panel.y_low, panel.y_high, std::clamp(static_cast<int>(panel.height_px / 24), 3, 6)))
    svg.y_tick(plot, to_px(panel, top, y), y);
  for (const double x : round_ticks(chart_.x_low, chart_.x_high, 10)) svg.x_grid(plot, to_px(x));
  svg.frame(plot);
  svg.y_title(plot, 22, panel.y_title);
}

void Drawing::draw_levels(SvgWriter& svg, const ChartPanel& panel, double top) const {
  double free_below = 1e9;  // names rise from the bottom and keep a line's distance
  std::vector<ChartLevel> rising = panel.levels;
  std::stable_sort(rising.begin(), rising.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  const double right = kLeft + plot_width_;
  for (const ChartLevel& level : rising) {
    if (level.y < panel.y_low || level.y > panel.y_high) continue;
    const double at = to_px(panel, top, level.y), name_at = std::min(at + 4.5, free_below);
    svg.path(SvgWriter::line(kLeft, at, 'H', right) + fmt::format("L{:.1f} {:.1f}", right + 8, name_at - 4.5),
             R"(fill="none" stroke="#5d6a75" stroke-dasharray="6 3")");
    svg.text({right + 11, name_at}, level.name);
    free_below = name_at - 17;
  }
}

void Drawing::draw_dots(SvgWriter& svg, const ChartPanel& panel, double top) const {
  for (const ChartDot& dot : panel.dots) {
    const double x = to_px(dot.x), high = to_px(panel, top, dot.y + dot.error);
    const double low = to_px(panel, top, dot.y - dot.error);
    svg.path(
        fmt::format("M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {1:.1f}h10M{3:.1f} {2:.1f}h10", x, high, low, x - 5),
        R"(stroke="#1d262e" stroke-width="1.6")");
    draw_dot(svg, {x, to_px(panel, top, dot.y)});
  }
}

void Drawing::draw_legend(SvgWriter& svg, const ChartPanel& panel, double top) const {
  if (legend_height(panel) < kLegendRow) return;
  Vertex at{kLeft, top - 8};
  svg.rect({kLeft, at.y - 15, plot_width_, 20}, R"(fill="#ffffff")");
  for (const ChartLine& line : panel.lines) {
    if (line.name.empty()) continue;
    svg.path(SvgWriter::line(at.x, at.y - 4.5, 'h', 28), stroke_of(line.stroke));
    svg.text({at.x + 34, at.y}, line.name);
    at.x += 34 + text_width(line.name) + 20;
  }
  if (panel.dots.empty()) return;
  draw_dot(svg, {at.x + 14, at.y - 4.5});
  svg.text({at.x + 26, at.y}, panel.dots_name);
}

void Drawing::draw_states(SvgWriter& svg) const {
  if (chart_.states.empty()) return;
  svg.rect({kLeft, states_top_ - 23, plot_width_, 20}, R"(fill="#ffffff")");
  svg.text({kLeft, states_top_ - 8}, chart_.states_title);
  for (std::size_t i = 0; i < chart_.states.size(); ++i) {
    const ChartState& state = chart_.states[i];
    const double y = states_top_ + kStateRow * static_cast<double>(i);
    svg.path(SvgWriter::line(kLeft, y + kStateRow, 'h', plot_width_), R"(stroke="#d3d8dc")");
    svg.text({kLeft - 7, y + 14}, state.name,
             fmt::format(R"(text-anchor="end" fill="{}")", state.alarm ? kAlarmInk : kInk));
    for (const ChartSpan& span : state.spans)
      svg.rect(
          {to_px(span.x_from), y + 4, std::max(to_px(span.x_to) - to_px(span.x_from), 1.0), kStateRow - 7},
          state.alarm ? R"(fill="#b00020")" : R"(fill="#55636f")");
  }
  svg.frame({kLeft, states_top_, plot_width_, plots_bottom_ - states_top_});
}

void Drawing::draw_x_axis(SvgWriter& svg) const {
  for (const double x : round_ticks(chart_.x_low, chart_.x_high, 10)) {
    svg.path(SvgWriter::line(to_px(x), plots_bottom_, 'v', 5), R"(stroke="#5d6a75")");
    svg.x_number(to_px(x), plots_bottom_ + 20, x);
  }
  svg.text({kLeft + plot_width_ / 2, plots_bottom_ + 41}, chart_.x_title, R"(text-anchor="middle")");
}

}  // namespace

std::string render(const Chart& chart) {
  return Drawing(chart).finished();
}

}  // namespace biopsy::report
