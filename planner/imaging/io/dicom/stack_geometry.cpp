#include "planner/imaging/io/dicom/stack_geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "robot/common/config_error.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

Direction normal_of(const SlicePlane& slice) {
  return slice.along_row.cross(slice.along_column).normalized();
}

void refuse_bad_plane(const SlicePlane& slice) {
  const std::string remedy = "export the series again with its original headers";
  const Direction &row = slice.along_row, &column = slice.along_column;
  if (!slice.p_SV.allFinite() || !row.allFinite() || !column.allFinite())
    throw ConfigError("position or orientation is not finite", slice.name, remedy);
  if (std::abs(row.norm() - 1.0) > 1e-3 || std::abs(column.norm() - 1.0) > 1e-3)
    throw ConfigError("the directions of ImageOrientationPatient do not have length 1", slice.name, remedy);
  if (std::abs(row.normalized().dot(column.normalized())) > kDirectionTolerance)
    throw ConfigError("rows and columns are not perpendicular", slice.name, remedy);
  const double low = std::min(slice.spacing_i_mm, slice.spacing_j_mm);
  const double high = std::max(slice.spacing_i_mm, slice.spacing_j_mm);
  if (!(low > 0.0) || !(high <= kSpacingMax_mm))
    throw ConfigError(fmt::format("PixelSpacing {:g} x {:g} mm is outside (0, {:g}]", slice.spacing_j_mm,
                                  slice.spacing_i_mm, kSpacingMax_mm),
                      slice.name, remedy);
}

void refuse_different_planes(const SlicePlane& first, const SlicePlane& slice) {
  const std::string both = first.name + " and " + slice.name;
  const double turn = std::max((first.along_row.normalized() - slice.along_row.normalized()).norm(),
                               (first.along_column.normalized() - slice.along_column.normalized()).norm());
  if (turn > kDirectionTolerance)
    throw ConfigError(
        fmt::format(
            "two orientations in one series: the slices are turned by {:.2f} degrees against each other",
            2.0 * std::asin(std::min(1.0, turn / 2.0)) * 180.0 / EIGEN_PI),
        both, "give a series of parallel slices: a localiser (scout) is no volume");
  if (first.columns != slice.columns || first.rows != slice.rows)
    throw ConfigError(fmt::format("two sizes in one series: {} x {} and {} x {}", first.columns, first.rows,
                                  slice.columns, slice.rows),
                      both, "separate the series, or leave the scout image out");
  if (std::abs(first.spacing_i_mm - slice.spacing_i_mm) > 1e-4 * first.spacing_i_mm ||
      std::abs(first.spacing_j_mm - slice.spacing_j_mm) > 1e-4 * first.spacing_j_mm)
    throw ConfigError(
        fmt::format("two pixel spacings in one series: {:g} x {:g} and {:g} x {:g} mm", first.spacing_j_mm,
                    first.spacing_i_mm, slice.spacing_j_mm, slice.spacing_i_mm),
        both, "separate the series");
}

std::vector<std::size_t> sorted_along(const Direction& normal, const std::vector<SlicePlane>& slices) {
  std::vector<std::size_t> order(slices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return normal.dot(slices[a].p_SV) < normal.dot(slices[b].p_SV);
  });
  return order;
}

void refuse_repeats_and_gaps(const std::vector<SlicePlane>& slices, const SliceStack& stack,
                             const Direction& normal) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < stack.order.size(); ++k) {
    const SlicePlane &below = slices[stack.order[k - 1]], &above = slices[stack.order[k]];
    gaps.push_back(normal.dot(above.p_SV - below.p_SV));
    if (gaps.back() < 0.01)
      throw ConfigError("not a volume: two slices at the same place", below.name + " and " + above.name,
                        "keep one time, echo or copy of the series in the folder");
  }
  const double usual = quantile(gaps, 0.5);  // robust against a missing or a doubled slice
  for (std::size_t k = 0; k < gaps.size(); ++k)
    if (std::abs(gaps[k] - usual) > kStackTolerance_mm)
      throw ConfigError(
          fmt::format(
              "uneven slices: a gap of {:.3f} mm where the others are {:.3f} mm (a slice is missing?)",
              gaps[k], usual),
          slices[stack.order[k]].name + " and " + slices[stack.order[k + 1]].name,
          "export the whole series again");
}

// Every slice must lie where the grid says; what is left is tilt (sideways) or creeping spacing (along the
// normal).
void refuse_off_grid(const std::vector<SlicePlane>& slices, const SliceStack& stack,
                     const Direction& normal) {
  const SlicePlane& first = slices[stack.order.front()];
  for (std::size_t k = 1; k < stack.order.size(); ++k) {
    const SlicePlane& slice = slices[stack.order[k]];
    const Eigen::Vector3d way = slice.p_SV - first.p_SV;
    const double sideways = (way - normal * normal.dot(way)).norm();
    if (sideways > kStackTolerance_mm)
      throw ConfigError(
          fmt::format(
              "tilted stack: slices are shifted sideways by {:.2f} mm over {:.2f} mm, so they are not "
              "perpendicular to the direction of stacking (gantry tilt, shear)",
              sideways, normal.dot(way)),
          first.name + " and " + slice.name, "reconstruct the series without tilt");
    const double creep = (way - stack.grid.X_SI.linear().col(2) * static_cast<double>(k)).norm();
    if (creep > 2 * kStackTolerance_mm)
      throw ConfigError(fmt::format("uneven slices: off a regular stack by {:.3f} mm", creep), slice.name,
                        "export the whole series again");
  }
}

void warn_of_contradictions(const SlicePlane& slice, SliceStack& stack) {
  const double gap = stack.grid.spacing_mm().z();
  const auto warn = [&](const char* what, double stated) {
    if (stated > 0.0 && std::abs(stated - gap) > 0.01 * gap)
      stack.warnings.push_back(fmt::format(
          "{} says {:g} mm, the slice positions say {:.4g} mm: the positions are used", what, stated, gap));
  };
  warn("SpacingBetweenSlices", slice.stated_gap_mm);
  warn("SliceThickness", slice.thickness_mm);
}

}  // namespace

namespace {

SliceStack stacked(const std::vector<SlicePlane>& slices, std::size_t least, double gap_of_one_mm) {
  if (slices.empty()) throw ConfigError("no slices", "series", "give a folder with an image series");
  for (const SlicePlane& slice : slices) refuse_bad_plane(slice);
  for (const SlicePlane& slice : slices) refuse_different_planes(slices.front(), slice);
  const SlicePlane& any = slices.front();
  if (slices.size() < least)
    throw ConfigError(fmt::format("only {} slice{}: a volume needs at least {}", slices.size(),
                                  slices.size() == 1 ? "" : "s", least),
                      any.name, "give the folder with the whole series");

  const Direction normal = normal_of(any);
  SliceStack stack;
  stack.order = sorted_along(normal, slices);
  const SlicePlane &first = slices[stack.order.front()], &last = slices[stack.order.back()];
  if (slices.size() > 1) refuse_repeats_and_gaps(slices, stack, normal);

  const double gap = slices.size() > 1
                         ? normal.dot(last.p_SV - first.p_SV) / static_cast<double>(slices.size() - 1)
                         : gap_of_one_mm;
  stack.grid.size = {any.columns, any.rows, static_cast<int>(slices.size())};
  stack.grid.X_SI.linear().col(0) = first.along_row.normalized() * first.spacing_i_mm;
  stack.grid.X_SI.linear().col(1) = first.along_column.normalized() * first.spacing_j_mm;
  stack.grid.X_SI.linear().col(2) = normal * gap;
  stack.grid.X_SI.translation() = first.p_SV;
  refuse_off_grid(slices, stack, normal);
  refuse_bad_grid(stack.grid, first.name, static_cast<int>(least));
  warn_of_contradictions(any, stack);
  return stack;
}

bool in_one_stack(const SlicePlane& a, const SlicePlane& b) {
  return a.columns == b.columns && a.rows == b.rows &&
         (a.along_row - b.along_row).norm() < kDirectionTolerance &&
         (a.along_column - b.along_column).norm() < kDirectionTolerance;
}

double stated_gap_mm(const SlicePlane& slice) {
  const double gap = slice.stated_gap_mm > 0.0 ? slice.stated_gap_mm : slice.thickness_mm;
  if (!(gap > 0.0))
    throw ConfigError("a single slice whose header states no thickness", slice.name,
                      "export it again with SliceThickness");
  return gap;
}

}  // namespace

SliceStack stack_slices(const std::vector<SlicePlane>& slices) {
  return stacked(slices, kSizeMin, 0.0);
}

std::vector<SliceStack> stack_slabs(const std::vector<SlicePlane>& slices) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t n = 0; n < slices.size(); ++n) {
    refuse_bad_plane(slices[n]);
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const std::vector<std::size_t>& group) {
      return in_one_stack(slices[group.front()], slices[n]);
    });
    if (known == groups.end())
      groups.push_back({n});
    else
      known->push_back(n);
  }
  std::vector<SliceStack> stacks;
  for (const std::vector<std::size_t>& group : groups) {
    std::vector<SlicePlane> planes;
    for (std::size_t n : group) planes.push_back(slices[n]);
    stacks.push_back(stacked(planes, 1, group.size() == 1 ? stated_gap_mm(planes.front()) : 0.0));
    for (std::size_t& n : stacks.back().order) n = group[n];
  }
  return stacks;
}

}  // namespace biopsy::imaging
