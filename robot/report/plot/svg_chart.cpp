#include "robot/report/plot/svg_chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "robot/common/sanitize_text.hpp"

namespace biopsy::report {
namespace {

// Layout, in SVG user units (the page scales the whole figure).
constexpr double kWidth = 1000, kLeft = 100, kTop = 8;
constexpr double kNameRow = 20;    // one row of names above the panels
constexpr double kLegendRow = 27;  // above each panel
constexpr double kStateRow = 21;
constexpr double kLetter = 8.2;  // generous width of a letter at 15 units, to keep names from touching
constexpr int kColumns = 1500;   // two per unit of the plot's width

// Saturated colour is for alarms only.
constexpr const char* kAlarm = "#b00020";
constexpr const char* kInk = "#1d262e";
constexpr const char* kGridInk = "#d3d8dc";

double text_width(const std::string& text) {
  return kLetter * static_cast<double>(text.size());
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) {}

  std::string finished() {
    place();
    draw_head();
    draw_shades();
    draw_bands();
    draw_markers();
    for (std::size_t i = 0; i < chart_.panels.size(); ++i) draw_panel(chart_.panels[i], tops_[i]);
    draw_states();
    draw_x_axis();
    svg_ += "</svg>";
    return std::move(svg_);
  }

 private:
  template <class... Values>
  void put(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
    svg_ += '\n';
  }

  double to_px(double x) const {
    return kLeft + plot_width_ * (x - chart_.x_low) / std::max(chart_.x_high - chart_.x_low, 1e-12);
  }
  static double to_px(const ChartPanel& panel, double top, double y) {
    return top + panel.height_px * (panel.y_high - y) / (panel.y_high - panel.y_low);
  }

  static double legend_height(const ChartPanel& panel);
  void place();
  double place_shade_names();
  void draw_head();
  void draw_shades();
  void draw_bands();
  void draw_markers();
  void draw_panel(const ChartPanel& panel, double top);
  void draw_grid(const ChartPanel& panel, double top);
  void draw_levels(const ChartPanel& panel, double top);
  void draw_line(const ChartPanel& panel, double top, const ChartLine& line);
  void draw_dots(const ChartPanel& panel, double top);
  void draw_legend(const ChartPanel& panel, double top);
  void draw_states();
  void draw_x_axis();

  const Chart& chart_;
  std::string svg_;
  std::vector<int> marker_rows_;
  std::vector<Vertex> shade_names_;  // where each shade's legend entry begins
  double plot_width_ = 0, names_top_ = 0, plots_top_ = 0, states_top_ = 0, plots_bottom_ = 0, height_ = 0;
  std::vector<double> tops_;  // of the panels
};

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

void Drawing::draw_head() {
  put(R"(<svg xmlns="http://www.w3.org/2000/svg" class="chart" role="img" viewBox="0 0 {:.0f} {:.0f}" )"
      R"(font-family="'DejaVu Sans',Arial,sans-serif" font-size="15" fill="{}">)",
      kWidth, height_, kInk);
  put("<title>{}</title><desc>{}</desc>", escaped(chart_.title), escaped(chart_.description));
  put(R"(<rect width="{:.0f}" height="{:.0f}" fill="#ffffff"/>)", kWidth, height_);
  if (!chart_.note.empty())
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end" font-weight="bold">{}</text>)", kWidth - 8,
        kTop + 12, escaped(chart_.note));
}

// One path a shade: a run may turn around hundreds of times.
void Drawing::draw_shades() {
  for (std::size_t i = 0; i < chart_.shades.size(); ++i) {
    const ChartShade& shade = chart_.shades[i];
    put(R"(<rect x="{:.1f}" y="{:.1f}" width="20" height="13" fill="{}" stroke="#5d6a75"/>)",
        shade_names_[i].x, shade_names_[i].y + 1, shade.colour);
    put(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", shade_names_[i].x + 26, shade_names_[i].y + 13,
        escaped(shade.name));
    svg_ += R"(<path class="shade" d=")";
    for (std::size_t p = 0; p < tops_.size(); ++p)
      for (const ChartSpan& span : shade.spans)
        fmt::format_to(std::back_inserter(svg_), "M{:.1f} {:.1f}H{:.1f}v{:.1f}H{:.1f}z", to_px(span.x_from),
                       tops_[p], std::max(to_px(span.x_to), to_px(span.x_from) + 0.3),
                       chart_.panels[p].height_px, to_px(span.x_from));
    put(R"(" fill="{}"/>)", shade.colour);
  }
}

// A named strip above the panels, and the same shade in every panel; legends between them stay on white.
void Drawing::draw_bands() {
  for (std::size_t i = 0; i < chart_.bands.size(); ++i) {
    const ChartBand& band = chart_.bands[i];
    const double from = to_px(band.span.x_from), to = std::max(to_px(band.span.x_to), from + 0.5);
    const char* colour = i % 2 ? "#e1e6e9" : "#eef1f3";
    const auto shade = [&](double top, double height) {
      put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>)", from, top, to - from,
          height, colour);
    };
    shade(plots_top_ - kNameRow, kNameRow);
    for (std::size_t p = 0; p < tops_.size(); ++p) shade(tops_[p], chart_.panels[p].height_px);
    if (!chart_.states.empty()) shade(states_top_, plots_bottom_ - states_top_);
    const std::string& name = text_width(band.name) < to - from ? band.name : band.short_name;
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", (from + to) / 2, plots_top_ - 5,
        escaped(name));
  }
}

void Drawing::draw_markers() {
  for (std::size_t i = 0; i < chart_.markers.size(); ++i) {
    const ChartMarker& marker = chart_.markers[i];
    const double x = to_px(marker.x), y = names_top_ + kNameRow * marker_rows_[i] + 13;
    const char* colour = marker.alarm ? kAlarm : kInk;
    put(R"(<path d="M{0:.1f} {1:.1f}V{2:.1f}M{0:.1f} {3:.1f}V{4:.1f}" stroke="{5}" stroke-width="{6}" )"
        R"(stroke-dasharray="{7}"/>)",
        x, y - 3, plots_top_ - kNameRow, plots_top_, plots_bottom_, colour, marker.alarm ? 1.8 : 1.0,
        marker.alarm ? "none" : "2 3");  // leaves out the strip with the bands' names
    put(R"(<path d="M{0:.1f} {1:.1f}l-5 -9h10z" fill="{2}"/>)", x, y - 1, colour);
    const bool leftwards = x + 9 + text_width(marker.name) > kWidth;
    put(R"(<text x="{:.1f}" y="{:.1f}" fill="{}" text-anchor="{}"{}>{}</text>)", leftwards ? x - 9 : x + 9, y,
        colour, leftwards ? "end" : "start", marker.alarm ? R"( font-weight="bold")" : "",
        escaped(marker.name));
  }
}

void Drawing::draw_panel(const ChartPanel& panel, double top) {
  draw_grid(panel, top);
  draw_levels(panel, top);
  put(R"(<svg x="{0:.1f}" y="{1:.1f}" width="{2:.1f}" height="{3:.1f}" viewBox="{0:.1f} {1:.1f} {2:.1f} {3:.1f}">)",
      kLeft, top, plot_width_, panel.height_px);  // clips lines that leave the panel
  for (const ChartLine& line : panel.lines) draw_line(panel, top, line);
  draw_dots(panel, top);
  put("</svg>");
  draw_legend(panel, top);
}

void Drawing::draw_grid(const ChartPanel& panel, double top) {
  const int ticks = std::clamp(static_cast<int>(panel.height_px / 24), 3, 6);
  for (const double y : round_ticks(panel.y_low, panel.y_high, ticks)) {
    const double at = to_px(panel, top, y);
    put(R"(<path d="M{:.1f} {:.1f}h{:.1f}" stroke="{}"/>)", kLeft, at, plot_width_, kGridInk);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)", kLeft - 7, at + 4.5, y);
  }
  for (const double x : round_ticks(chart_.x_low, chart_.x_high, 10))
    put(R"(<path d="M{:.1f} {:.1f}v{:.1f}" stroke="{}"/>)", to_px(x), top, panel.height_px, kGridInk);
  put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#5d6a75"/>)", kLeft,
      top, plot_width_, panel.height_px);
  const double middle = top + panel.height_px / 2;
  put(R"svg(<text transform="translate(22 {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)svg", middle,
      escaped(panel.y_title));
}

void Drawing::draw_levels(const ChartPanel& panel, double top) {
  double free_below = 1e9;  // names rise from the bottom and keep a line's distance
  std::vector<ChartLevel> rising = panel.levels;
  std::stable_sort(rising.begin(), rising.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  for (const ChartLevel& level : rising) {
    if (level.y < panel.y_low || level.y > panel.y_high) continue;
    const double at = to_px(panel, top, level.y), name_at = std::min(at + 4.5, free_below);
    put(R"(<path d="M{:.1f} {:.1f}H{:.1f}L{:.1f} {:.1f}" fill="none" stroke="#5d6a75" stroke-dasharray="6 3"/>)",
        kLeft, at, kLeft + plot_width_, kLeft + plot_width_ + 8, name_at - 4.5);
    put(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", kLeft + plot_width_ + 11, name_at, escaped(level.name));
    free_below = name_at - 17;
  }
}

void Drawing::draw_line(const ChartPanel& panel, double top, const ChartLine& line) {
  if (line.points.empty()) return;
  svg_ += R"(<path fill="none" stroke-linejoin="round" d=")";
  char command = 'M';
  for (const Vertex& v : decimated(line.points, chart_.x_low, chart_.x_high, kColumns)) {
    if (!std::isfinite(v.y)) {
      command = 'M';  // a gap in what is known is a gap in the line
      continue;
    }
    fmt::format_to(std::back_inserter(svg_), "{}{:.1f} {:.1f}", command, to_px(v.x), to_px(panel, top, v.y));
    command = 'L';
  }
  put(R"(" stroke="{}" stroke-width="{}" stroke-dasharray="{}"/>)", line.stroke.colour, line.stroke.width,
      line.stroke.dash.empty() ? "none" : line.stroke.dash);
}

void Drawing::draw_dots(const ChartPanel& panel, double top) {
  for (const ChartDot& dot : panel.dots) {
    const double x = to_px(dot.x), high = to_px(panel, top, dot.y + dot.error);
    const double low = to_px(panel, top, dot.y - dot.error);
    put(R"(<path d="M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {1:.1f}h10M{3:.1f} {2:.1f}h10" stroke="{4}" stroke-width="1.6"/>)",
        x, high, low, x - 5, kInk);
    put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4.5" fill="#ffffff" stroke="{}" stroke-width="1.8"/>)", x,
        to_px(panel, top, dot.y), kInk);
  }
}

void Drawing::draw_legend(const ChartPanel& panel, double top) {
  if (legend_height(panel) < kLegendRow) return;
  double x = kLeft;
  const double y = top - 8;
  put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="20" fill="#ffffff"/>)", kLeft, y - 15,
      plot_width_);
  for (const ChartLine& line : panel.lines) {
    if (line.name.empty()) continue;
    put(R"(<path d="M{:.1f} {:.1f}h28" stroke="{}" stroke-width="{}" stroke-dasharray="{}"/>)", x, y - 4.5,
        line.stroke.colour, line.stroke.width, line.stroke.dash.empty() ? "none" : line.stroke.dash);
    put(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", x + 34, y, escaped(line.name));
    x += 34 + text_width(line.name) + 20;
  }
  if (panel.dots.empty()) return;
  put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="4.5" fill="#ffffff" stroke="{}" stroke-width="1.8"/>)", x + 14,
      y - 4.5, kInk);
  put(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", x + 26, y, escaped(panel.dots_name));
}

void Drawing::draw_states() {
  if (chart_.states.empty()) return;
  put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="20" fill="#ffffff"/>)", kLeft, states_top_ - 23,
      plot_width_);
  put(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", kLeft, states_top_ - 8, escaped(chart_.states_title));
  for (std::size_t i = 0; i < chart_.states.size(); ++i) {
    const ChartState& state = chart_.states[i];
    const double y = states_top_ + kStateRow * static_cast<double>(i);
    const char* colour = state.alarm ? kAlarm : "#55636f";
    put(R"(<path d="M{:.1f} {:.1f}h{:.1f}" stroke="{}"/>)", kLeft, y + kStateRow, plot_width_, kGridInk);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end" fill="{}">{}</text>)", kLeft - 7, y + 14,
        state.alarm ? kAlarm : kInk, escaped(state.name));
    for (const ChartSpan& span : state.spans)
      put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>)", to_px(span.x_from),
          y + 4, std::max(to_px(span.x_to) - to_px(span.x_from), 1.0), kStateRow - 7, colour);
  }
  put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#5d6a75"/>)", kLeft,
      states_top_, plot_width_, plots_bottom_ - states_top_);
}

void Drawing::draw_x_axis() {
  for (const double x : round_ticks(chart_.x_low, chart_.x_high, 10)) {
    put(R"(<path d="M{:.1f} {:.1f}v5" stroke="#5d6a75"/>)", to_px(x), plots_bottom_);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)", to_px(x), plots_bottom_ + 20, x);
  }
  put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", kLeft + plot_width_ / 2,
      plots_bottom_ + 41, escaped(chart_.x_title));
}

}  // namespace

std::string render(const Chart& chart) {
  return Drawing(chart).finished();
}

}  // namespace biopsy::report
