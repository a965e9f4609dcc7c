#include "robot/report/plot/svg_writer.hpp"

#include <cmath>

#include "robot/common/text/sanitize_text.hpp"

namespace biopsy::report {

SvgWriter::SvgWriter(const SvgDocument& document) {
  put(R"(<svg xmlns="http://www.w3.org/2000/svg" class="{}" role="img" viewBox="0 0 {:.0f} {:.0f}" )"
      R"(font-family="'DejaVu Sans',Arial,sans-serif" font-size="{}" fill="{}">)",
      document.css_class, document.width, document.height, document.font_size, document.ink);
  put("<title>{}</title>", escaped(document.title));
  if (!document.description.empty()) put("<desc>{}</desc>", escaped(document.description));
  put(R"(<rect width="{:.0f}" height="{:.0f}" fill="{}"/>)", document.width, document.height,
      document.ground);
}

void SvgWriter::text(Vertex at, std::string_view content, std::string_view attributes) {
  if (content.empty()) return;
  put(R"(<text x="{:.1f}" y="{:.1f}"{}{}>{}</text>)", at.x, at.y, attributes.empty() ? "" : " ", attributes,
      escaped(content));
}

void SvgWriter::rect(const PlotArea& area, std::string_view attributes) {
  put(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" {}/>)", area.left, area.top, area.width,
      area.height, attributes);
}

void SvgWriter::path(std::string_view shape, std::string_view attributes) {
  put(R"(<path d="{}" {}/>)", shape, attributes);
}

void SvgWriter::polyline(const std::vector<Vertex>& points, std::string_view attributes) {
  if (points.empty()) return;
  std::string shape;
  char command = 'M';
  for (const Vertex& v : points) {
    const bool known = std::isfinite(v.x) && std::isfinite(v.y);
    if (known) fmt::format_to(std::back_inserter(shape), "{}{:.1f} {:.1f}", command, v.x, v.y);
    command = known ? 'L' : 'M';
  }
  put(R"(<path fill="none" stroke-linejoin="round" d="{}" {}/>)", shape, attributes);
}

void SvgWriter::begin_clip(const PlotArea& area) {
  put(R"(<svg x="{0:.1f}" y="{1:.1f}" width="{2:.1f}" height="{3:.1f}" viewBox="{0:.1f} {1:.1f} {2:.1f} {3:.1f}">)",
      area.left, area.top, area.width, area.height);
}

void SvgWriter::y_tick(const PlotArea& area, double at, double value) {
  path(line(area.left, at, 'H', area.right()), grid());
  text({area.left - 7, at + 4.5}, fmt::format("{:g}", value), R"(text-anchor="end")");
}

void SvgWriter::x_number(double at, double y, double value) {
  text({at, y}, fmt::format("{:g}", value), R"(text-anchor="middle")");
}

void SvgWriter::frame(const PlotArea& area) {
  rect(area, R"(fill="none" stroke="#5d6a75")");
}

void SvgWriter::y_title(const PlotArea& area, double left, std::string_view title) {
  put(R"svg(<text transform="translate({:.0f} {:.1f}) rotate(-90)" text-anchor="middle">{}</text>)svg", left,
      area.top + area.height / 2, escaped(title));
}

}  // namespace biopsy::report
