// biopsy image: what was read of an image.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/registration/orthogonal_slices.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/procedure/images/anatomical_orientation.hpp"
#include "robot/report/plot/png.hpp"

namespace biopsy::robot {
namespace image_cli {

using Json = nlohmann::ordered_json;

struct Options {
  std::filesystem::path path;
  std::string series;
  std::filesystem::path png;  // folder for pictures; empty: none
};

void declare(CLI::App& app, Options& options) {
  add(app, "PATH", options.path, "a DICOM folder or file, NIfTI or NRRD")->required();
  add(app, "--series UID", options.series, "series UID, where the folder holds several");
  add(app, "--png FOLDER", options.png, "folder for an axial, a coronal and a sagittal picture",
      "no pictures");
}

std::string list_text(const std::vector<imaging::SeriesSummary>& all) {
  std::string text = fmt::format("{} series:\n", all.size());
  for (const imaging::SeriesSummary& one : all)
    text += fmt::format("  {}\n    {} {} \"{}\", {} x {} x {}, {:.3g} x {:.3g} x {:.3g} mm{}\n",
                        one.series_uid, one.format, one.modality, one.description, one.size.x(), one.size.y(),
                        one.size.z(), one.spacing_mm.x(), one.spacing_mm.y(), one.spacing_mm.z(),
                        one.problem.empty() ? "" : "\n    cannot be used: " + one.problem);
  return text;
}

Json list_json(const std::vector<imaging::SeriesSummary>& all) {
  Json list = Json::array();
  for (const imaging::SeriesSummary& one : all)
    list.push_back({{"series_uid", one.series_uid},
                    {"format", one.format},
                    {"modality", one.modality},
                    {"description", one.description},
                    {"size", {one.size.x(), one.size.y(), one.size.z()}},
                    {"spacing_mm", {one.spacing_mm.x(), one.spacing_mm.y(), one.spacing_mm.z()}},
                    {"problem", one.problem.empty() ? Json(nullptr) : Json(one.problem)}});
  return list;
}

struct Extent {
  Point first, last;  // centres of the first and the last voxel, R, A, S in mm
  float low, high;
};

Extent extent_of(const Volume& volume) {
  const Grid& grid = volume.grid;
  const auto [low, high] = std::minmax_element(volume.voxels.begin(), volume.voxels.end());
  return {ras_from_lps(grid.X_SI.translation()),
          ras_from_lps(grid.X_SI * (grid.size - Eigen::Vector3i::Ones()).cast<double>()), *low, *high};
}

std::string volume_text(const Volume& volume) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3d spacing = grid.spacing_mm();
  const SeriesIdentity& id = volume.identity;
  const Extent extent = extent_of(volume);
  const auto point = [](const Point& p) {
    return fmt::format("{}, {}, {} mm (R, A, S)", fixed(p.x(), 3), fixed(p.y(), 3), fixed(p.z(), 3));
  };
  std::string text =
      fmt::format("format       {}, {}\n", volume.format, counted(volume.files.size(), "file"));
  text += fmt::format("patient      {} ({})\nseries       {} {}\n             {}\n", id.patient_name,
                      id.patient_id, id.modality, id.description, id.series_uid);
  text += fmt::format("size         {} x {} x {} voxels\n", grid.size.x(), grid.size.y(), grid.size.z());
  text += fmt::format("spacing      {:.4f} x {:.4f} x {:.4f} mm\n", spacing.x(), spacing.y(), spacing.z());
  for (int axis = 0; axis < 3; ++axis)
    text += fmt::format("{}            points to {}\n", "ijk"[axis],
                        side_shares(grid.X_SI.linear().col(axis).normalized()));
  text += fmt::format("first voxel  {}\nlast voxel   {}\nvalues       {:g} to {:g}\n", point(extent.first),
                      point(extent.last), extent.low + 0.0F, extent.high + 0.0F);
  for (const std::string& warning : volume.warnings) text += fmt::format("warning      {}\n", warning);
  return text;
}

Json volume_json(const Volume& volume) {
  const Grid& grid = volume.grid;
  const Eigen::Vector3d spacing = grid.spacing_mm();
  const SeriesIdentity& id = volume.identity;
  const Extent extent = extent_of(volume);
  const auto list = [](const auto& v) { return Json{v.x(), v.y(), v.z()}; };
  Json directions = Json::array();  // of i, j, k in R, A, S
  for (int axis = 0; axis < 3; ++axis)
    directions.push_back(list(ras_from_lps(grid.X_SI.linear().col(axis).normalized())));
  return {{"format", volume.format},
          {"files", volume.files.size()},
          {"patient_name", id.patient_name},
          {"patient_id", id.patient_id},
          {"modality", id.modality},
          {"description", id.description},
          {"series_uid", id.series_uid},
          {"size", list(grid.size)},
          {"spacing_mm", list(spacing)},
          {"directions_ras", directions},
          {"first_voxel_ras_mm", list(extent.first)},
          {"last_voxel_ras_mm", list(extent.last)},
          {"lowest", extent.low},
          {"highest", extent.high},
          {"warnings", volume.warnings}};
}

std::string json_text(const Json& series, const Json& volume, const std::vector<std::string>& pictures) {
  const Json all = {{"series", series}, {"image", volume}, {"pictures", pictures}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result run(const Options& options, const Context&) {
  const std::vector<imaging::SeriesSummary> all = imaging::list_series(options.path);
  if (all.size() > 1 && options.series.empty()) {
    if (!options.png.empty())
      throw ConfigError("pictures of which series? There are " + std::to_string(all.size()),
                        options.path.string(), "choose one with --series; `biopsy image PATH` lists them");
    return {.text = list_text(all) + "\nchoose one with --series UID\n",
            .json = json_text(list_json(all), nullptr, {})};
  }
  const Volume volume = imaging::read_volume(options.path, options.series);
  std::string text = (all.size() > 1 ? list_text(all) : "") + volume_text(volume);
  std::vector<std::string> pictures;
  if (!options.png.empty()) {
    make_output_folder(options.png, {options.path}, {});
    for (const auto& [name, picture] : imaging::orthogonal_slices(volume)) {
      pictures.push_back((options.png / (name + ".png")).string());
      report::save_png(picture, pictures.back());
      text += fmt::format("picture      {}\n", pictures.back());
    }
  }
  return {.text = text, .json = json_text(list_json(all), volume_json(volume), pictures)};
}

}  // namespace image_cli

Command image_command() {
  using namespace image_cli;
  return {.name = "image",
          .summary = "what an image is: geometry, orientation, warnings",
          .examples = {"biopsy image out/gap/planning --png out/slices"},
          .exit_codes = "0, or 2 for unusable input",
          .outputs = {{"axial.png", "with `--png`, as `coronal.png` and `sagittal.png`"}},
          .json =
              "`series`: list of `series_uid`, `format`, `modality`, `description`, `size` in voxels, "
              "`spacing_mm`, `problem` (why it cannot be used, or `null`); `image`, `null` where one of "
              "several must be chosen: the same, `files`, `patient_name`, `patient_id`, `directions_ras` of "
              "the voxel axes i, j, k, `first_voxel_ras_mm`, `last_voxel_ras_mm`, `lowest`, `highest`, "
              "`warnings`; `pictures`: list of files",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
