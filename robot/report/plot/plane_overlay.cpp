#include "robot/report/plot/plane_overlay.hpp"

#include <algorithm>
#include <array>

#include "robot/report/plot/png.hpp"
#include "robot/report/plot/svg_writer.hpp"

namespace biopsy::report {
namespace {

constexpr double kSide = 300.0, kCaption = 46.0;  // SVG units
constexpr const char* kBlackRim = R"(stroke="#000000" stroke-width="3" paint-order="stroke")";

void put_lines(SvgWriter& svg, const std::string& shape, const char* colour, const char* dashes) {
  svg.path(shape, R"(fill="none" stroke="#000000" stroke-width="3.2")");
  svg.path(shape, fmt::format(R"(fill="none" stroke="{}" stroke-width="1.4" {})", colour, dashes));
}

}  // namespace

std::string plane_overlay(const BodyPlane& plane, bool simulated) {
  const Picture& picture = plane.picture;
  if (picture.width <= 0 || picture.height <= 0) return {};
  SvgWriter svg({.css_class = "needle",
                 .width = kSide,
                 .height = kSide + kCaption,
                 .font_size = 13,
                 .ground = "#000000",
                 .ink = "#ffffff",
                 .title = plane.name + " plane through the target"});
  svg.put(R"(<image x="0" y="0" width="{0:.1f}" height="{0:.1f}" href="{1}"/>)", kSide,
          png_data_uri(picture));
  const double scale = kSide / picture.width;
  const auto on_sheet = [&](const std::array<double, 2>& px) {
    return Vertex{(px[0] + 0.5) * scale, (px[1] + 0.5) * scale};
  };
  const Vertex entry = on_sheet(plane.entry_px), target = on_sheet(plane.target_px);
  constexpr double kGap = 12.0;
  svg.begin_clip({0, 0, kSide, kSide});
  put_lines(svg, fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", entry.x, entry.y, target.x, target.y), "#ffe600",
            "");
  put_lines(
      svg,
      fmt::format("M0 {1:.1f}H{2:.1f}M{3:.1f} {1:.1f}H{4:.0f}M{0:.1f} 0V{5:.1f}M{0:.1f} {6:.1f}V{4:.0f}",
                  target.x, target.y, target.x - kGap, target.x + kGap, kSide, target.y - kGap,
                  target.y + kGap),
      "#ff4dff", R"(stroke-dasharray="4 4")");
  svg.end_clip();
  const auto side = [&](double x, double y, const char* anchor, const std::string& letters) {
    svg.text({x, y}, letters, fmt::format(R"({} text-anchor="{}" font-weight="bold")", kBlackRim, anchor));
  };
  side(5, kSide / 2 - 5, "start", plane.left);
  side(kSide - 5, kSide / 2 - 5, "end", plane.right);
  side(kSide / 2 + 12, 15, "middle", plane.top);
  side(kSide / 2 + 12, kSide - 5, "middle", plane.bottom);
  svg.text({6, kSide + 18}, plane.name + ", " + plane.place, R"(font-weight="bold")");
  svg.text({6, kSide + 37}, plane.window);
  if (simulated) side(kSide - 6, kSide + 37, "end", "SIMULATED");
  return svg.finished();
}

Picture difference_of(const Picture& before, const Picture& after) {
  if (before.width != after.width || before.height != after.height || before.rgb.size() != after.rgb.size())
    return {};
  Picture difference = Picture::blank(after.width, after.height, after.mm_per_pixel);
  for (std::size_t n = 0; n + 2 < after.rgb.size(); n += 3) {
    const auto is_grey = [n](const Picture& picture) {
      return picture.rgb[n] == picture.rgb[n + 1] && picture.rgb[n] == picture.rgb[n + 2];
    };
    int value = 128;
    if (is_grey(before) && is_grey(after)) value += (int{after.rgb[n]} - int{before.rgb[n]}) / 2;
    std::fill_n(difference.rgb.begin() + static_cast<std::ptrdiff_t>(n), 3,
                static_cast<std::uint8_t>(std::clamp(value, 0, 255)));
  }
  return difference;
}

}  // namespace biopsy::report
