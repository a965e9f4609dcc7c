#include "planner/plan/layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

#include "robot/common/config_error.hpp"

namespace biopsy::planner {
namespace {

constexpr double kBoundaryPrecision_mm = 1e-3;

// A stretch of the path with one label.
struct Run {
  int label;
  double from, to;  // mm from the entry
};

// The path through a label volume: which label at which distance.
class LabelPath {
 public:
  LabelPath(const Volume& labels, const Point& p_SE, const Direction& axis_S)
      : labels_(labels), p_SE_(p_SE), axis_S_(axis_S.normalized()), X_IS_(labels.grid.X_SI.inverse()) {}

  int label(double distance_mm) const {
    const Point p_I = X_IS_ * (p_SE_ + distance_mm * axis_S_);
    const Eigen::Vector3d nearest = (p_I.array() + 0.5).floor();
    const Eigen::Vector3d last = labels_.grid.size.cast<double>().array() - 1.0;
    if (!((nearest.array() >= 0.0).all() && (nearest.array() <= last.array()).all()))
      throw ConfigError(
          fmt::format("the needle path leaves the label map {:.1f} mm from the entry", distance_mm), where(),
          "use a label map that covers the whole path, on the frame of the planning image");
    const Eigen::Vector3i index = nearest.cast<int>();
    const float value = labels_.at(index.x(), index.y(), index.z());
    if (!(std::abs(value) < 1e6F) || value != std::round(value))
      throw ConfigError(fmt::format("label value {} is not a whole number", value), where(),
                        "give a label map (segmentation), not an image");
    return static_cast<int>(value);
  }

  // Where label `first` ends between a (inside it) and b (outside it).
  double boundary(double a, double b, int first) const {
    while (b - a > kBoundaryPrecision_mm) {
      const double middle = 0.5 * (a + b);
      (label(middle) == first ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }

  double step_mm() const { return 0.25 * labels_.grid.spacing_mm().minCoeff(); }

  // Length of path from one voxel layer to the next along the index axis it advances on fastest.
  double voxel_mm() const { return 1.0 / (X_IS_.linear() * axis_S_).cwiseAbs().maxCoeff(); }

 private:
  std::string where() const { return labels_.files.empty() ? "label map" : labels_.files.front(); }

  const Volume& labels_;
  Point p_SE_;
  Direction axis_S_;
  AffineTransform X_IS_;
};

std::vector<Run> runs_along(const LabelPath& path, double length) {
  const int steps = std::max(1, static_cast<int>(std::ceil(length / path.step_mm())));
  std::vector<Run> runs{{path.label(0.0), 0.0, length}};
  double previous = 0.0;
  for (int n = 1; n <= steps; ++n) {
    const double here = length * n / steps;
    if (const int label = path.label(here); label != runs.back().label) {
      const double boundary = path.boundary(previous, here, runs.back().label);
      runs.back().to = boundary;
      runs.push_back({label, boundary, length});
    }
    previous = here;
  }
  return runs;
}

// Takes out run n: neighbours of one label become one, others meet in its middle.
void dissolve(std::vector<Run>& runs, std::size_t n) {
  const Run sliver = runs[n];
  const auto at = runs.begin() + static_cast<std::ptrdiff_t>(n);
  if (n == 0) {
    runs[1].from = sliver.from;
  } else if (n + 1 == runs.size()) {
    runs[n - 1].to = sliver.to;
  } else if (runs[n - 1].label == runs[n + 1].label) {
    runs[n - 1].to = runs[n + 1].to;
    runs.erase(at, at + 2);
    return;
  } else {
    runs[n - 1].to = runs[n + 1].from = 0.5 * (sliver.from + sliver.to);
  }
  runs.erase(at);
}

void drop_slivers(std::vector<Run>& runs, double thinnest) {
  const auto thickness = [](const Run& run) { return run.to - run.from; };
  while (runs.size() > 1) {
    const auto thin = std::min_element(
        runs.begin(), runs.end(), [&](const Run& a, const Run& b) { return thickness(a) < thickness(b); });
    if (thickness(*thin) >= thinnest) return;
    dissolve(runs, static_cast<std::size_t>(thin - runs.begin()));
  }
}

std::string name_of(int label, const LabelNames& names) {
  if (const auto found = names.find(label); found != names.end()) return found->second;
  return label == 0 ? "unlabelled" : fmt::format("label {}", label);
}

}  // namespace

std::vector<Layer> layers_along_path(const Volume& labels, const Point& p_SE, const Direction& axis_S,
                                     Millimetres length, const LabelNames& names) {
  assert(length.value > 0.0 && axis_S.norm() > 0.5);
  const LabelPath path(labels, p_SE, axis_S);
  std::vector<Run> runs = runs_along(path, length.value);
  drop_slivers(runs, 0.5 * path.voxel_mm());
  std::vector<Layer> layers;
  layers.reserve(runs.size());
  for (const Run& run : runs)
    layers.push_back({name_of(run.label, names), Millimetres(run.from), Millimetres(run.to)});
  return layers;
}

std::string layer_fault(const std::vector<Layer>& layers) {
  constexpr double kTouching_mm = 1e-6;
  if (layers.empty()) return "there is no tissue layer";
  double end = 0.0;
  for (const Layer& layer : layers) {
    if (layer.name.empty()) return fmt::format("the layer at {:.2f} mm has no name", layer.from.value);
    if (!std::isfinite(layer.from.value) || !std::isfinite(layer.to.value))
      return fmt::format("a bound of layer '{}' is not a number", layer.name);
    if (std::abs(layer.from.value - end) > kTouching_mm)
      return fmt::format(
          "layer '{}' begins at {:.3f} mm, but {} {:.3f} mm", layer.name, layer.from.value,
          &layer == layers.data() ? "the first layer begins at" : "the layer before it ends at", end);
    if (!(layer.to > layer.from))
      return fmt::format("layer '{}' ends at {:.3f} mm, not behind its beginning", layer.name,
                         layer.to.value);
    end = layer.to.value;
  }
  return {};
}

void check_layers(const std::vector<Layer>& layers, const std::string& where) {
  if (const std::string fault = layer_fault(layers); !fault.empty())
    throw ConfigError(
        fault, where,
        "list the layers from the entry inwards, each beginning where the one before ends, in mm");
}

}  // namespace biopsy::planner
