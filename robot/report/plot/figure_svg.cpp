#include "robot/report/plot/figure_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "robot/common/sanitize_text.hpp"
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
constexpr const char* kDashedColour = "#1d262e";
constexpr std::array kDashes{"7 4", "2 3", "10 3 2 3"};

double text_width(const std::string& text) {
  const auto letters = std::count_if(text.begin(), text.end(), [](char b) { return (b & 0xC0) != 0x80; });
  return kFigureLetter * static_cast<double>(letters);
}

std::vector<std::string> wrapped(const std::string& text, double width) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (!lines.back().empty() && text_width(lines.back() + " " + word) > width) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  if (lines.size() > kMostLines) lines.resize(kMostLines);
  return lines;
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
  Panel(const FigurePanel& panel, const FigureSize& size) : panel_(panel), size_(size) {}

  std::string finished() {
    place();
    draw_head();
    draw_axes();
    put(R"(<svg x="{0:.1f}" y="{1:.1f}" width="{2:.1f}" height="{3:.1f}" viewBox="{0:.1f} {1:.1f} {2:.1f} {3:.1f}">)",
        kLeft, top_, plot_width_, size_.plot_height);  // clips what leaves the panel
    for (const bool dashed : {false, true})            // a target is seen on what follows it
      for (std::size_t i = 0; i < panel_.curves.size(); ++i)
        if (panel_.curves[i].dashed == dashed) draw_curve(i);
    put("</svg>");
    for (std::size_t i = 0; i < panel_.curves.size(); ++i) draw_marks(i);  // whole ones also on the frame
    draw_legend();
    svg_ += "</svg>";
    return std::move(svg_);
  }

 private:
  template <class... Values>
  void put(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
    svg_ += '\n';
  }

  double scaled(double x) const { return panel_.logarithmic_x ? std::log10(x) : x; }  // NaN or -inf: a gap
  double to_px_x(double x) const {
    const double low = scaled(panel_.x_low), high = scaled(panel_.x_high);
    return kLeft + plot_width_ * (scaled(x) - low) / (high > low ? high - low : 1.0);
  }
  double to_px_y(double y) const {
    const double range = panel_.y_high - panel_.y_low;
    return top_ + size_.plot_height * (panel_.y_high - y) / (range > 0.0 ? range : 1.0);
  }
  std::string ink(std::size_t curve) const;

  void place();
  void draw_head();
  void draw_axes();
  void draw_x_ticks();
  void draw_curve(std::size_t curve);
  void draw_marks(std::size_t curve);
  std::vector<std::vector<Vertex>> pieces(const FigureCurve& curve) const;
  void draw_legend();

  const FigurePanel& panel_;
  const FigureSize size_;
  std::string svg_;
  std::vector<std::string> title_;
  std::vector<Vertex> names_;  // where each curve's legend entry begins; x below 0: none
  double plot_width_ = 0, top_ = 0, height_ = 0;
};

void Panel::place() {
  plot_width_ = size_.width - kLeft - kRight;
  title_ = wrapped(panel_.title, size_.width - 16);
  Vertex at{kLeft, panel_.title.empty() ? 6 : 4 + kTitleRow * static_cast<double>(title_.size())};
  bool any = false;
  for (const FigureCurve& curve : panel_.curves) {
    if (curve.name.empty()) {
      names_.push_back({-1, 0});
      continue;
    }
    const double width = kSwatch + 6 + text_width(curve.name) + 16;
    if (at.x > kLeft && at.x + width > size_.width) at = {kLeft, at.y + kLegendRow};
    names_.push_back(at);
    at.x += width;
    any = true;
  }
  top_ = at.y + (any ? kLegendRow : 0) + 6;
  height_ = top_ + size_.plot_height + kBelow;
}

std::string Panel::ink(std::size_t curve) const {
  std::size_t before = 0;  // curves of its kind before it
  for (std::size_t i = 0; i < curve; ++i) before += panel_.curves[i].dashed == panel_.curves[curve].dashed;
  if (panel_.curves[curve].dashed)
    return fmt::format(R"(stroke="{}" stroke-width="1.4" stroke-dasharray="{}")", kDashedColour,
                       kDashes[before % kDashes.size()]);
  return fmt::format(R"(stroke="{}" stroke-width="1.6")", kColours[before % kColours.size()]);
}

void Panel::draw_head() {
  put(R"(<svg xmlns="http://www.w3.org/2000/svg" class="panel" role="img" viewBox="0 0 {:.0f} {:.0f}" )"
      R"(font-family="'DejaVu Sans',Arial,sans-serif" font-size="14" fill="#1d262e">)",
      size_.width, height_);
  put("<title>{}</title><desc>{} against {}</desc>", escaped(panel_.title), escaped(panel_.y_title),
      escaped(panel_.x_title));
  put(R"(<rect width="{:.0f}" height="{:.0f}" fill="#ffffff"/>)", size_.width, height_);
  for (std::size_t i = 0; i < title_.size() && !panel_.title.empty(); ++i)
    put(R"(<text x="8" y="{:.1f}" font-weight="bold">{}</text>)", 18 + kTitleRow * static_cast<double>(i),
        escaped(title_[i]));
}

void Panel::draw_axes() {
  const double bottom = top_ + size_.plot_height;
  for (const double y : round_ticks(panel_.y_low, panel_.y_high, 5)) {
    put(R"(<path d="M{:.1f} {:.1f}h{:.1f}" stroke="#d3d8dc"/>)", kLeft, to_px_y(y), plot_width_);
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="end">{:g}</text>)", kLeft - 7, to_px_y(y) + 4.5, y);
  }
  draw_x_ticks();
  put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#5d6a75"/>)", kLeft,
      top_, plot_width_, size_.plot_height);
  put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{}</text>)", kLeft + plot_width_ / 2, bottom + 40,
      escaped(panel_.x_title));
  put(R"svg(<text transform="translate(16 {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)svg",
      top_ + size_.plot_height / 2, escaped(panel_.y_title));
}

void Panel::draw_x_ticks() {
  LogarithmicTicks ticks;
  if (panel_.logarithmic_x)
    ticks = logarithmic_ticks(panel_.x_low, panel_.x_high);
  else
    ticks.all = ticks.named = round_ticks(panel_.x_low, panel_.x_high, static_cast<int>(plot_width_ / 65));
  for (const double x : ticks.all)
    put(R"(<path d="M{:.1f} {:.1f}v{:.1f}" stroke="#d3d8dc"/>)", to_px_x(x), top_, size_.plot_height);
  for (const double x : ticks.named)
    put(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="middle">{:g}</text>)", to_px_x(x),
        top_ + size_.plot_height + 19, x);
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

void Panel::draw_curve(std::size_t i) {
  if (panel_.curves[i].marks) return;
  for (const std::vector<Vertex>& piece : pieces(panel_.curves[i])) {
    if (piece.empty()) continue;
    svg_ += R"(<path fill="none" stroke-linejoin="round" d=")";
    char command = 'M';
    for (const Vertex& v : thinned(piece, kLeft, kLeft + plot_width_)) {
      fmt::format_to(std::back_inserter(svg_), "{}{:.1f} {:.1f}", command, v.x, v.y);
      command = 'L';
    }
    put("\" {}/>", ink(i));
  }
}

void Panel::draw_marks(std::size_t i) {
  if (!panel_.curves[i].marks) return;
  const double right = kLeft + plot_width_ + kNearest, bottom = top_ + size_.plot_height + kNearest;
  for (const std::vector<Vertex>& piece : pieces(panel_.curves[i]))
    for (const Vertex& v : piece)
      if (v.x > kLeft - kNearest && v.x < right && v.y > top_ - kNearest && v.y < bottom)
        put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.6" fill="#ffffff" {}/>)", v.x, v.y, ink(i));
}

void Panel::draw_legend() {
  for (std::size_t i = 0; i < panel_.curves.size(); ++i) {
    const Vertex at = names_[i];
    if (at.x < 0) continue;
    if (panel_.curves[i].marks)
      put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.6" fill="#ffffff" {}/>)", at.x + kSwatch / 2, at.y + 9,
          ink(i));
    else
      put(R"(<path d="M{:.1f} {:.1f}h{:.1f}" fill="none" {}/>)", at.x, at.y + 9, kSwatch, ink(i));
    put(R"(<text x="{:.1f}" y="{:.1f}">{}</text>)", at.x + kSwatch + 6, at.y + 14,
        escaped(panel_.curves[i].name));
  }
}

}  // namespace

std::string figure_svg(const FigurePanel& panel, const FigureSize& size) {
  return Panel(panel, size).finished();
}

}  // namespace biopsy::report
