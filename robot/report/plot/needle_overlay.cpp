#include "robot/report/plot/needle_overlay.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/plot/png.hpp"
#include "robot/report/plot/svg_writer.hpp"

namespace biopsy::report {
namespace {

// Colours of the console: drawn on black image area, not alarms.
constexpr const char* kEntry = "#00e5ff";
constexpr const char* kTarget = "#ff4dff";
constexpr const char* kPath = "#ffe600";

constexpr double kViewSize = 430;       // of one square view, SVG units
constexpr double kLabelStep = 20;       // between lines of labels
constexpr double kOverlayLetter = 9.8;  // generous width of a letter at 16 units
constexpr double kClosestView_mm = 10.0;

// A square window of the slice shown at (left, top) on the sheet.
class View {
 public:
  View(const Picture& slice, const SliceGeometry& geometry, Vertex corner_px, double size_px, Vertex at)
      : slice_(slice),
        geometry_(geometry),
        corner_(corner_px),
        at_(at),
        scale_(kViewSize / size_px),
        size_px_(size_px) {}

  Vertex on_sheet(double depth_mm) const {
    const double along_px = depth_mm / geometry_.mm_per_pixel;
    return {at_.x + (geometry_.entry_x_px + geometry_.axis_dx * along_px - corner_.x) * scale_,
            at_.y + (geometry_.entry_y_px + geometry_.axis_dy * along_px - corner_.y) * scale_};
  }
  double units_per_mm() const { return scale_ / geometry_.mm_per_pixel; }
  double width_mm() const { return size_px_ * geometry_.mm_per_pixel; }
  Vertex at() const { return at_; }
  Vertex axis() const { return {geometry_.axis_dx, geometry_.axis_dy}; }
  std::string image() const {
    const int x = static_cast<int>(std::floor(corner_.x)), y = static_cast<int>(std::floor(corner_.y));
    const int size = static_cast<int>(std::ceil(size_px_)) + 1;
    return fmt::format(
        R"(<svg x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" viewBox="{:.3f} {:.3f} {:.3f} {:.3f}">)"
        R"(<image x="{}" y="{}" width="{}" height="{}" href="{}"/></svg>)",
        at_.x, at_.y, kViewSize, kViewSize, corner_.x, corner_.y, size_px_, size_px_, x, y, size, size,
        png_data_uri(cropped(slice_, x, y, size, size)));
  }

 private:
  const Picture& slice_;
  const SliceGeometry& geometry_;
  Vertex corner_, at_;
  double scale_, size_px_;
};

View whole_view(const Picture& slice, const SliceGeometry& geometry, Vertex at) {
  const double size = std::max(slice.width, slice.height);
  return {slice, geometry, {(slice.width - size) / 2, (slice.height - size) / 2}, size, at};
}

View close_view(const Picture& slice, const SliceGeometry& geometry, double depth_mm, Vertex at) {
  const double size = std::max(kClosestView_mm, 2.4 * depth_mm) / geometry.mm_per_pixel;
  const double middle_px = 0.5 * depth_mm / geometry.mm_per_pixel;
  return {slice,
          geometry,
          {geometry.entry_x_px + geometry.axis_dx * middle_px - size / 2,
           geometry.entry_y_px + geometry.axis_dy * middle_px - size / 2},
          size,
          at};
}

struct Label {
  Vertex point;  // what it names
  std::string text;
};

// Every drawing and every text has a black outline below it, so that it shows on bright tissue too.
constexpr const char* kOutlined = R"(stroke="#000000" stroke-width="3" paint-order="stroke")";

class Sheet {
 public:
  Sheet(double width, double height, const OverlayText& text)
      : svg_({.css_class = "needle",
              .width = width,
              .height = height,
              .font_size = 16,
              .ground = "#000000",
              .ink = "#ffffff",
              .title = text.title}),
        note_at_{width - 8, height - 10},
        note_(text.note) {}

  std::string finished() {
    svg_.text(note_at_, note_, fmt::format(R"({} text-anchor="end" font-weight="bold")", kOutlined));
    return svg_.finished();
  }

  void add_image(const View& view) { svg_.put("{}", view.image()); }
  void add_path(const View& view, double depth_mm);
  void add_entry(const View& view);
  void add_target(const View& view, double depth_mm);
  void add_tip(const View& view, const DepthCheck& check);
  void add_tick(const View& view, double depth_mm);
  void add_scale_bar(const View& view);
  void add_frame(Vertex corner, double size);
  void add_labels(const View& view, std::vector<Label> labels, double left);
  void add_lines(const View& view, const std::vector<std::string>& lines);
  void add_sides(const View& view, const SliceGeometry& geometry);

 private:
  void put_outlined(const std::string& shape, const char* colour, double width) {
    for (const auto& [ink, broad] : {std::pair("#000000", width + 2), std::pair(colour, width)})
      svg_.path(shape, fmt::format(R"(fill="none" stroke="{}" stroke-width="{}")", ink, broad));
  }

  SvgWriter svg_;
  Vertex note_at_;
  std::string note_;
};

std::string across(Vertex p, Vertex axis, double half_length) {
  return fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", p.x - half_length * axis.y, p.y + half_length * axis.x,
                     p.x + half_length * axis.y, p.y - half_length * axis.x);
}

void Sheet::add_path(const View& view, double depth_mm) {
  const Vertex from = view.on_sheet(0), to = view.on_sheet(depth_mm);
  put_outlined(fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", from.x, from.y, to.x, to.y), kPath, 1.6);
}

void Sheet::add_entry(const View& view) {
  const Vertex p = view.on_sheet(0);
  put_outlined(fmt::format("M{:.1f} {:.1f}a7 7 0 1 0 14 0a7 7 0 1 0 -14 0", p.x - 7, p.y), kEntry, 2);
}

void Sheet::add_target(const View& view, double depth_mm) {
  const Vertex p = view.on_sheet(depth_mm);
  put_outlined(fmt::format("M{:.1f} {:.1f}l20 20m0 -20l-20 20", p.x - 10, p.y - 10), kTarget, 2);
}

void Sheet::add_tip(const View& view, const DepthCheck& check) {
  const Vertex tip = view.on_sheet(check.depth.value);
  std::string bar;
  for (const double spread : {-2 * check.sigma.value, 2 * check.sigma.value}) {
    const Vertex end = view.on_sheet(check.depth.value + spread);
    bar +=
        fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", tip.x, tip.y, end.x, end.y) + across(end, view.axis(), 6);
  }
  put_outlined(bar, "#ffffff", 1.6);
  svg_.put(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.5" fill="#ffffff" stroke="#000000"/>)", tip.x, tip.y);
}

void Sheet::add_tick(const View& view, double depth_mm) {
  put_outlined(across(view.on_sheet(depth_mm), view.axis(), 11), kPath, 1.6);
}

// About a quarter of the view, in round millimetres.
void Sheet::add_scale_bar(const View& view) {
  const double rough = view.width_mm() / 4, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double length = rough >= 5 * power ? 5 * power : rough >= 2 * power ? 2 * power : power;
  const double x = view.at().x + 14, y = view.at().y + kViewSize - 14;
  put_outlined(fmt::format("M{:.1f} {:.1f}v6h{:.1f}v-6", x, y - 6, length * view.units_per_mm()), "#ffffff",
               1.6);
  svg_.text({x, y - 11}, fmt::format("{:g} mm", length), kOutlined);
}

void Sheet::add_frame(Vertex corner, double size) {
  svg_.rect({corner.x, corner.y, size, size}, R"(fill="none" stroke="#ffffff" stroke-dasharray="4 3")");
}

// A column of texts from x = `left`, in the order of their points, a line apart, each with a leader to its
// point.
void Sheet::add_labels(const View& view, std::vector<Label> labels, double left) {
  std::stable_sort(labels.begin(), labels.end(),
                   [](const auto& a, const auto& b) { return a.point.y < b.point.y; });
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const Vertex point = labels[i].point;
    const double rows = static_cast<double>(labels.size() - 1), row = static_cast<double>(i);
    const double fanned = point.y + kLabelStep * (row - rows / 2) + 5;  // spread around the points
    const double lowest = view.at().y + kViewSize - 40 - kLabelStep * (rows - row);
    const double y = std::min(fanned, lowest);
    svg_.path(fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}H{:.1f}", point.x + 15, point.y, left - 20, y - 5.5,
                          left - 4),
              R"(fill="none" stroke="#ffffff" stroke-opacity="0.8")");
    svg_.text({left, y}, labels[i].text, kOutlined);
  }
}

// Lines in the upper left corner, away from the needle, which runs through the middle.
void Sheet::add_lines(const View& view, const std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i)
    svg_.text({view.at().x + 10, view.at().y + 22 + kLabelStep * static_cast<double>(i)}, lines[i],
              kOutlined);
}

// The patient's sides at the edges of the view.
void Sheet::add_sides(const View& view, const SliceGeometry& geometry) {
  const double middle = kViewSize / 2, edge = kViewSize - 10;
  const auto letters = [&](double x, double y, const char* anchor, const std::string& side) {
    svg_.text({view.at().x + x, view.at().y + y}, side,
              fmt::format(R"({} text-anchor="{}" font-weight="bold")", kOutlined, anchor));
  };
  letters(8, middle + 5, "start", geometry.left);
  letters(edge, middle + 5, "end", geometry.right);
  letters(middle, 20, "middle", geometry.top);
  letters(middle, edge, "middle", geometry.bottom);
}

double widest(const std::vector<Label>& labels) {
  std::size_t letters = 0;
  for (const Label& label : labels) letters = std::max(letters, display_width(label.text));
  return kOverlayLetter * static_cast<double>(letters);
}

std::vector<Label> planning_labels(const View& view, const Plan& plan, double deepest_mm) {
  std::vector<Label> labels{{view.on_sheet(0), "entry 0.00 mm"}};
  for (std::size_t i = 1; i < plan.layers.size(); ++i) {
    const Layer& layer = plan.layers[i];
    if (layer.from.value > deepest_mm) continue;
    labels.push_back(
        {view.on_sheet(layer.from.value),
         fmt::format("{} | {} {}", plan.layers[i - 1].name, layer.name, fixed(layer.from.value, 2, "mm"))});
  }
  labels.push_back(
      {view.on_sheet(plan.target_depth.value), "target " + fixed(plan.target_depth.value, 2, "mm")});
  return labels;
}

}  // namespace

std::string planning_overlay(const Picture& slice, const SliceGeometry& geometry, const Plan& plan,
                             const OverlayText& text) {
  if (slice.width <= 0 || slice.height <= 0) return {};
  assert(geometry.mm_per_pixel > 0);
  const double target = plan.target_depth.value;
  const View whole = whole_view(slice, geometry, {0, 0});
  const View close = close_view(slice, geometry, target, {kViewSize + 8, 0});
  std::vector<Label> labels = planning_labels(close, plan, 1.5 * target);
  const double left = 2 * kViewSize + 8 + 12;
  Sheet sheet(left + std::max(120.0, widest(labels)), kViewSize, text);
  for (const View* view : {&whole, &close}) {
    sheet.add_image(*view);
    sheet.add_path(*view, target);
    sheet.add_scale_bar(*view);
  }
  sheet.add_sides(whole, geometry);
  const Vertex middle = whole.on_sheet(target / 2);
  const double frame = close.width_mm() * whole.units_per_mm();
  sheet.add_frame({middle.x - frame / 2, middle.y - frame / 2}, frame);
  for (std::size_t i = 1; i < plan.layers.size(); ++i)
    if (plan.layers[i].from.value <= 1.5 * target) sheet.add_tick(close, plan.layers[i].from.value);
  sheet.add_entry(close);
  sheet.add_target(close, target);
  sheet.add_labels(close, std::move(labels), left);
  return sheet.finished();
}

std::string tip_overlay(const Picture& slice, const SliceGeometry& geometry, const TipDepths& depths,
                        const OverlayText& text) {
  if (slice.width <= 0 || slice.height <= 0) return {};
  assert(geometry.mm_per_pixel > 0);
  const double planned = depths.planned.value;
  const View close = close_view(slice, geometry, depths.shown.value, {0, 0});
  Sheet sheet(kViewSize, kViewSize, text);
  sheet.add_image(close);
  sheet.add_entry(close);
  sheet.add_target(close, planned);
  std::vector<std::string> lines{"planned " + fixed(planned, 2, "mm")};
  if (depths.check && depths.check->tip_found) {
    sheet.add_tip(close, *depths.check);
    const DepthCheck& check = *depths.check;
    lines.push_back("found " + fixed(check.depth.value, 2, "mm"));
    if (check.tip_offset_known)
      lines.push_back("void ends " + fixed(check.depth.value + check.tip_offset_mm, 2, "mm") + ", offset " +
                      fixed(check.tip_offset_mm, 2, "mm"));
  }
  sheet.add_lines(close, lines);
  sheet.add_scale_bar(close);
  return sheet.finished();
}

Picture cropped(const Picture& picture, int x, int y, int width, int height) {
  Picture part = Picture::blank(width, height, picture.mm_per_pixel);
  const int from = std::clamp(-x, 0, width), to = std::clamp(picture.width - x, from, width);
  for (int row = std::max(0, -y); row < height && row + y < picture.height; ++row) {
    const auto at = [](int line, int column, int wide) {
      return 3 * (static_cast<std::ptrdiff_t>(line) * wide + column);
    };
    if (to > from)
      std::copy_n(picture.rgb.begin() + at(row + y, from + x, picture.width), 3 * (to - from),
                  part.rgb.begin() + at(row, from, width));
  }
  return part;
}

}  // namespace biopsy::report
