// The elements that every SVG of a report is made of. Text is escaped; coordinates are rounded to 0.1 units,
// so that equal input gives equal bytes. Lengths are SVG user units; the page scales the whole picture.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::report {

constexpr const char* kInk = "#1d262e";
constexpr const char* kGridInk = "#d3d8dc";
constexpr const char* kFrameInk = "#5d6a75";
constexpr const char* kAlarmInk = "#b00020";  // the only saturated red

struct Vertex {
  double x = 0, y = 0;
};

struct PlotArea {
  double left = 0, top = 0, width = 0, height = 0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

struct SvgDocument {
  std::string css_class;
  double width = 0, height = 0, font_size = 15;
  std::string ground = "#ffffff", ink = kInk;
  std::string title = {}, description = {};  // for screen readers
};

class SvgWriter {
 public:
  explicit SvgWriter(const SvgDocument& document);
  std::string finished() { return svg_ + "</svg>"; }

  // One element, as written.
  template <class... Values>
  void put(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
    svg_ += '\n';
  }
  // Nothing for an empty text. `attributes` as written, such as `text-anchor="end"`.
  void text(Vertex at, std::string_view content, std::string_view attributes = "");
  void rect(const PlotArea& area, std::string_view attributes);
  void path(std::string_view shape, std::string_view attributes);
  // A vertex that is not finite is a gap in the line.
  void polyline(const std::vector<Vertex>& points, std::string_view attributes);

  // What is drawn between the two is cut off at the edges of `area`.
  void begin_clip(const PlotArea& area);
  void end_clip() { put("</svg>"); }

  // Grid line and number at each tick; `at`: where the tick lies.
  void x_grid(const PlotArea& area, double at) { path(line(at, area.top, 'V', area.bottom()), grid()); }
  void y_tick(const PlotArea& area, double at, double value);
  void x_number(double at, double y, double value);
  void frame(const PlotArea& area);
  // Turned by 90 degrees, at x = `left`.
  void y_title(const PlotArea& area, double left, std::string_view title);

  static std::string line(double x, double y, char direction, double to) {
    return fmt::format("M{:.1f} {:.1f}{}{:.1f}", x, y, direction, to);
  }

 private:
  static std::string_view grid() { return R"(stroke="#d3d8dc")"; }
  std::string svg_;
};

}  // namespace biopsy::report
