// biopsy image: what was read of an image.
#include <fmt/format.h>

#include <algorithm>

#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/registration/orthogonal_slices.hpp"
#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "robot/procedure/anatomical_orientation.hpp"
#include "robot/report/plot/png.hpp"

namespace biopsy::robot {
namespace {

void print_list(const std::vector<imaging::SeriesSummary>& all) {
  fmt::print("{} series:\n", all.size());
  for (const imaging::SeriesSummary& one : all)
    fmt::print("  {}\n    {} {} \"{}\", {} x {} x {}, {:.3g} x {:.3g} x {:.3g} mm{}\n", one.series_uid,
               one.format, one.modality, one.description, one.size.x(), one.size.y(), one.size.z(),
               one.spacing_mm.x(), one.spacing_mm.y(), one.spacing_mm.z(),
               one.problem.empty() ? "" : "\n    cannot be used: " + one.problem);
}

void print_volume(const Volume& volume) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3d spacing = grid.spacing_mm();
  const auto [low, high] = std::minmax_element(volume.voxels.begin(), volume.voxels.end());
  const SeriesIdentity& id = volume.identity;
  const Point first = ras_from_lps(grid.X_SI.translation());
  const Point last = ras_from_lps(grid.X_SI * (grid.size - Eigen::Vector3i::Ones()).cast<double>());
  fmt::print("format       {}, {} files\n", volume.format, volume.files.size());
  fmt::print("patient      {} ({})\nseries       {} {}\n             {}\n", id.patient_name, id.patient_id,
             id.modality, id.description, id.series_uid);
  fmt::print("size         {} x {} x {} voxels\n", grid.size.x(), grid.size.y(), grid.size.z());
  fmt::print("spacing      {:.4f} x {:.4f} x {:.4f} mm\n", spacing.x(), spacing.y(), spacing.z());
  for (int axis = 0; axis < 3; ++axis)
    fmt::print("{}            points to {}\n", "ijk"[axis],
               side_shares(grid.X_SI.linear().col(axis).normalized()));
  fmt::print("first voxel  {:.3f}, {:.3f}, {:.3f} mm (R, A, S)\n", first.x(), first.y(), first.z());
  fmt::print("last voxel   {:.3f}, {:.3f}, {:.3f} mm (R, A, S)\n", last.x(), last.y(), last.z());
  fmt::print("values       {:g} to {:g}\n", *low, *high);
  for (const std::string& warning : volume.warnings) fmt::print("warning      {}\n", warning);
}

}  // namespace

int image(const ImageOptions& options) {
  const std::vector<imaging::SeriesSummary> all = imaging::list_series(options.path);
  if (all.size() > 1) print_list(all);
  if (all.size() > 1 && options.series.empty()) {
    fmt::print("\nchoose one with --series UID\n");
    return 0;
  }
  const Volume volume = imaging::read_volume(options.path, options.series);
  print_volume(volume);
  if (options.png.empty()) return 0;
  for (const auto& [name, picture] : imaging::orthogonal_slices(volume)) {
    report::save_png(picture, options.png / (name + ".png"));
    fmt::print("picture      {}\n", (options.png / (name + ".png")).string());
  }
  return 0;
}

}  // namespace biopsy::robot
