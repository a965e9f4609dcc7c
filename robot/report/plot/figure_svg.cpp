#include "robot/report/plot/figure_svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robot/common/text/text_layout.hpp"
#include "robot/report/plot/svg_chart.hpp"

namespace biopsy::report {
namespace {

constexpr double kLeft = 66, kRight = 16, kTitleRow = 24, kLegendRow = 20, kBelow = 50;
constexpr double kFigureLetter = 7.6;  // generous width of a letter at 14 units
constexpr double kSwatch = 30;         // a curve's sample in the legend
constexpr double kNearest = 0.3;       // units between two points of a curve that can be told apart
constexpr std::size_t kMostLines = 4;  // of a title

// Told apart by people who see few colours, and in grey print by their order of darkness. Red is for alarms.
constexpr std::array kColours{"#005fa8", "#b85c00", "#0a6b4f", "#5b2a73", "#8b959d", "#1d262e"};
constexpr std::array kDashes{"7 4", "2 3", "10 3 2 3"};

double text_width(const std::string& text) {
  return kFigureLetter * static_cast<double>(display_width(text));
}

// Points that a reader can tell apart. Where x never falls: first, lowest, highest and last of each column.
std::vector<Vertex> thinned(const std::vector<Vertex>& points, double from, double to) {
  const auto left_of = [](const Vertex& a, const Vertex& b) { return a.x < b.x; };
  if (std::is_sorted(points.begin(), points.end(), left_of))
    return decimated(points, from, to, static_cast<int>(2 * (to - from)));
  std::vector<Vertex> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool near =
        !kept.empty() && std::hypot(points[i].x - kept.back().x, points[i].y - kept.back().y) < kNearest;
    if (!near || i + 1 == points.size()) kept.push_back(points[i]);
  }
  return kept;
}

class Panel {
 public:
  Panel(const FigurePanel& panel, const FigureSize& size) : panel_(panel), width_(size.width) {
    place(size.plot_height);
  }
  std::string finished() const;

 private:
  double scaled(double x) const { return panel_.logarithmic_x ? std::log10(x) : x; }  // NaN or -inf: a gap
  double to_px_x(double x) const {
    const double low = scaled(panel_.x_low), high = scaled(panel_.x_high);
    return plot_.left + plot_.width * (scaled(x) - low) / (high > low ? high - low : 1.0);
  }
  double to_px_y(double y) const {
    const double range = panel_.y_high - panel_.y_low;
    return plot_.top + plot_.height * (panel_.y_high - y) / (range > 0.0 ? range : 1.0);
  }
  std::string ink(std::size_t curve) const;

  void place(double plot_height);
  void draw_axes(SvgWriter& svg) const;
  void draw_curve(SvgWriter& svg, std::size_t curve) const;
  void draw_marks(SvgWriter& svg, std::size_t curve) const;
  void draw_mark(SvgWriter& svg, Vertex at, std::size_t curve) const;
  void draw_legend(SvgWriter& svg) const;
  std::vector<std::vector<Vertex>> pieces(const FigureCurve& curve) const;

  const FigurePanel& panel_;
  double width_;
  PlotArea plot_;
  std::vector<std::string> title_;
  std::vector<Vertex> names_;  // where each curve's legend entry begins; x below 0: none
};

std::string Panel::finished() const {
  SvgWriter svg({.css_class = "panel",
                 .width = width_,
                 .height = plot_.bottom() + kBelow,
                 .font_size = 14,
                 .title = panel_.title,
                 .description = panel_.y_title + " against " + panel_.x_title});
  for (std::size_t i = 0; i < title_.size(); ++i)
    svg.text({8, 18 + kTitleRow * static_cast<double>(i)}, title_[i], R"(font-weight="bold")");
  draw_axes(svg);
  svg.begin_clip(plot_);
  for (const bool dashed : {false, true})  // a target is seen on what follows it
    for (std::size_t i = 0; i < panel_.curves.size(); ++i)
      if (panel_.curves[i].dashed == dashed) draw_curve(svg, i);
  svg.end_clip();
  for (std::size_t i = 0; i < panel_.curves.size(); ++i) draw_marks(svg, i);  // whole ones also on the frame
  draw_legend(svg);
  return svg.finished();
}

void Panel::place(double plot_height) {
  if (!panel_.title.empty())
    title_ = wrapped(panel_.title, static_cast<std::size_t>((width_ - 16) / kFigureLetter));
  title_.resize(std::min(title_.size(), kMostLines));
  Vertex at{kLeft, title_.empty() ? 6 : 4 + kTitleRow * static_cast<double>(title_.size())};
  bool any = false;
  for (const FigureCurve& curve : panel_.curves) {
    if (curve.name.empty()) {
      names_.push_back({-1, 0});
      continue;
    }
    const double width = kSwatch + 6 + text_width(curve.name) + 16;
    if (at.x > kLeft && at.x + width > width_) at = {kLeft, at.y + kLegendRow};
    names_.push_back(at);
    at.x += width;
    any = true;
  }
  plot_ = {kLeft, at.y + (any ? kLegendRow : 0) + 6, width_ - kLeft - kRight, plot_height};
}

std::string Panel::ink(std::size_t curve) const {
  std::size_t before = 0;  // curves of its kind before it
  for (std::size_t i = 0; i < curve; ++i) before += panel_.curves[i].dashed == panel_.curves[curve].dashed;
  if (panel_.curves[curve].dashed)
    return fmt::format(R"(stroke="{}" stroke-width="1.4" stroke-dasharray="{}")", kInk,
                       kDashes[before % kDashes.size()]);
  return fmt::format(R"(stroke="{}" stroke-width="1.6")", kColours[before % kColours.size()]);
}

void Panel::draw_axes(SvgWriter& svg) const {
  for (const double y : round_ticks(panel_.y_low, panel_.y_high, 5)) svg.y_tick(plot_, to_px_y(y), y);
  LogarithmicTicks ticks;
  if (panel_.logarithmic_x)
    ticks = logarithmic_ticks(panel_.x_low, panel_.x_high);
  else
    ticks.all = ticks.named = round_ticks(panel_.x_low, panel_.x_high, static_cast<int>(plot_.width / 65));
  for (const double x : ticks.all) svg.x_grid(plot_, to_px_x(x));
  for (const double x : ticks.named) svg.x_number(to_px_x(x), plot_.bottom() + 19, x);
  svg.frame(plot_);
  svg.text({plot_.left + plot_.width / 2, plot_.bottom() + 40}, panel_.x_title, R"(text-anchor="middle")");
  svg.y_title(plot_, 16, panel_.y_title);
}

// The curve in units of the picture, parted where a value is missing.
std::vector<std::vector<Vertex>> Panel::pieces(const FigureCurve& curve) const {
  std::vector<std::vector<Vertex>> parts(1);
  for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
    const Vertex at{to_px_x(curve.x[i]), to_px_y(curve.y[i])};
    if (std::isfinite(at.x) && std::isfinite(at.y))
      parts.back().push_back(at);
    else if (!parts.back().empty())
      parts.emplace_back();
  }
  return parts;
}

void Panel::draw_curve(SvgWriter& svg, std::size_t i) const {
  if (panel_.curves[i].marks) return;
  for (const std::vector<Vertex>& piece : pieces(panel_.curves[i]))
    svg.polyline(thinned(piece, plot_.left, plot_.right()), ink(i));
}

void Panel::draw_mark(SvgWriter& svg, Vertex at, std::size_t curve) const {
  svg.put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.6" fill="#ffffff" {}/>)", at.x, at.y, ink(curve));
}

void Panel::draw_marks(SvgWriter& svg, std::size_t i) const {
  const FigureCurve& curve = panel_.curves[i];
  if (!curve.marks) return;
  for (std::size_t k = 0; k < std::min(curve.x.size(), curve.y.size()); ++k) {
    const Vertex v{to_px_x(curve.x[k]), to_px_y(curve.y[k])};  // not a number: in no range
    if (!(v.x > plot_.left - kNearest && v.x < plot_.right() + kNearest && v.y > plot_.top - kNearest &&
          v.y < plot_.bottom() + kNearest))
      continue;
    draw_mark(svg, v, i);
    if (curve.numbered) svg.text({v.x + 5.0, v.y - 4.0}, fmt::format("{}", k + 1));
  }
}

void Panel::draw_legend(SvgWriter& svg) const {
  for (std::size_t i = 0; i < panel_.curves.size(); ++i) {
    const Vertex at = names_[i];
    if (at.x < 0) continue;
    if (panel_.curves[i].marks)
      draw_mark(svg, {at.x + kSwatch / 2, at.y + 9}, i);
    else
      svg.path(SvgWriter::line(at.x, at.y + 9, 'h', kSwatch), R"(fill="none" )" + ink(i));
    svg.text({at.x + kSwatch + 6, at.y + 14}, panel_.curves[i].name);
  }
}

}  // namespace

std::string figure_svg(const FigurePanel& panel, const FigureSize& size) {
  return Panel(panel, size).finished();
}

}  // namespace biopsy::report
