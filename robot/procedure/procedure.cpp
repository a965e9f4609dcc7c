#include "robot/procedure/procedure.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "planner/imaging/io/dicom/plan_structure_set.hpp"
#include "planner/plan/fiducial_file.hpp"
#include "planner/plan/markups/plan_markups.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/operator_name.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/common/text/ras_point.hpp"
#include "robot/procedure/case/controller_file.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/procedure/operator.hpp"
#include "robot/procedure/provenance.hpp"
#include "robot/report/procedure/report.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/tissue/tissue.hpp"

namespace biopsy::robot {

namespace fs = std::filesystem;

namespace {

ImageSource image_source(const ProcedureOptions& options) {
  const auto milliseconds = [](double seconds) {
    return std::chrono::milliseconds(static_cast<std::int64_t>(seconds * 1e3));
  };
  if (!options.images_from.empty() && !fs::is_directory(options.images_from))
    throw ConfigError("there is no such folder", options.images_from.string(),
                      "give the folder into which the scanner exports its series");
  return {options.images_from, milliseconds(options.images_quiet_s), milliseconds(options.images_patience_s),
          options.images_confirmed_by, options.images_planes};
}

// Entry and target of an image that is given without a case.
void take_points(const ProcedureOptions& options, Points points, Case& given) {
  if (!options.markups.empty()) {
    take_markups(options.markups, options.entry.empty() ? "entry" : options.entry,
                 options.target.empty() ? "target" : options.target, given);
    return;
  }
  if (options.entry.empty() && options.target.empty() && points == Points::PickedLater) return;
  if (options.entry.empty() || options.target.empty())
    throw ConfigError("--image without --entry and --target", "command line",
                      "pick both points: --entry R,A,S --target R,A,S, or --markups FILE");
  given.p_SE = parse_ras_point("--entry", options.entry);
  given.p_ST = parse_ras_point("--target", options.target);
}

}  // namespace

Case case_of(const ProcedureOptions& options, Points points) {
  const bool by_image = !options.image.empty();
  if (by_image && !options.case_name.empty())
    throw ConfigError("both a case and --image", "command line",
                      "give a case file, or --image with --entry and --target");
  if (!by_image && (!options.entry.empty() || !options.target.empty() || !options.labels.empty() ||
                    !options.markups.empty()))
    throw ConfigError("--entry, --target, --markups or --labels without --image", "command line",
                      "add --image PATH");
  Case given = by_image ? blank_case() : read_case(options.case_name.empty() ? "liver" : options.case_name);
  if (by_image) {
    given.image = options.image;
    given.title = (options.image / "").parent_path().filename().string();
    take_points(options, points, given);
    given.labels = options.labels;
  }
  if (options.labels_anyway && given.labels.empty())
    throw ConfigError("without labels", "--labels-anyway",
                      "give the label map with --labels, or leave it out");
  given.labels_anyway = options.labels_anyway;
  if (!options.series.empty() && given.phantom)
    throw ConfigError("--series with a built-in phantom, which has one series only", "command line",
                      "leave it out, or give the folder with --image");
  if (!options.series.empty()) given.series_uid = options.series;
  if (!options.fiducials.empty()) given.fiducials = options.fiducials;
  if (!options.model.empty()) given.rehearsal.model = options.model;
  if (!options.controller.empty()) given.gains = read_controller_file(options.controller);
  if (options.seed) given.seed = *options.seed;
  given.images = image_source(options);
  Seconds& scan = given.rehearsal.scan;
  if (options.real_time) scan = std::min(scan, kFastScan);  // people do not wait for an image that is drawn
  if (options.scan_s) scan = Seconds(*options.scan_s);
  return given;
}

namespace {

// Half a voxel beyond the centres of the outermost ones.
bool lies_inside(const Grid& grid, const Point& p_S) {
  const Eigen::Vector3d index = grid.X_SI.inverse() * p_S;
  const Eigen::Vector3d last = grid.size.cast<double>().array() - 0.5;
  return (index.array() >= -0.5).all() && (index.array() <= last.array()).all();
}

// Points are typed as R, A, S; other programs, and DICOM itself, write L, P, S.
Point as_if_lps(const Point& p_S) {
  return {-p_S.x(), -p_S.y(), p_S.z()};
}

std::string ras_text(const Point& p_S) {
  const Point ras = ras_from_lps(p_S);
  return fmt::format("R, A, S {}, {}, {} mm", fixed(ras.x(), 1), fixed(ras.y(), 1), fixed(ras.z(), 1));
}

void refuse_outside(const PreparedCase& prepared) {
  const Grid& grid = prepared.image.grid;
  for (const auto& [name, point] :
       {std::pair("entry", prepared.given.p_SE), std::pair("target", prepared.given.p_ST)}) {
    if (!point || lies_inside(grid, *point)) continue;
    const std::string hint =
        prepared.given.markups.empty() && lies_inside(grid, as_if_lps(*point))
            ? fmt::format(
                  "; read as L, P, S the same numbers lie inside it, at {}: turn the first two signs "
                  "if they were copied from a program that shows L, P, S",
                  ras_text(as_if_lps(*point)))
            : "";
    throw ConfigError(fmt::format("the {} at {} lies outside the image{}", name, ras_text(*point), hint),
                      prepared.given.image.string(),
                      "`biopsy image` prints where its first and last voxel lie; give a point between them");
  }
}

// Both readings lie in the image: only a person knows which was meant.
void ask_for_the_frame(PreparedCase& prepared) {
  const Grid& grid = prepared.image.grid;
  const auto& [entry, target] = std::pair(prepared.given.p_SE, prepared.given.p_ST);
  if (!entry || !target || !prepared.given.markups.empty()) return;  // markups say their frame
  const Point other = as_if_lps(*target);
  if (!lies_inside(grid, as_if_lps(*entry)) || !lies_inside(grid, other)) return;
  if ((other - *target).norm() < 1.0) return;  // the same place for a robot
  prepared.plan_warnings.push_back(
      fmt::format("were the points typed as R, A, S? Read as L, P, S they lie in the image too: the target "
                  "would then be at "
                  "{}, {} from where it is planned",
                  ras_text(other), fixed((other - *target).norm(), 1, "mm")));
}

// What is read later, in the middle of a run.
void check_files(const Case& given) {
  sim::read_model(given.rehearsal.model);
  sim::read_tissues(given.rehearsal.tissues);
  if (!given.fiducials.empty()) planner::read_fiducials(given.fiducials);
}

// After the report, which does not depend on it: the image may be gone by the end of a run. Returns why there
// is none where there should be.
std::string export_plan(const report::RunRecord& record, const PreparedCase& prepared, const fs::path& out) {
  if (!record.plan || !imaging::takes_structure_set(prepared.image)) return {};
  try {
    imaging::write_plan_structure_set(*record.plan, prepared.image, out / "plan.rtss.dcm");
  } catch (const ConfigError& error) {
    return fmt::format("no plan.rtss.dcm: {}\n", error.what());
  }
  return {};
}

}  // namespace

PreparedCase prepare_run(const Case& given, const fs::path& out, const std::vector<std::string>& clearable) {
  check_files(given);
  ProgressLine line;
  line.show(-1.0, "reading the image and planning");
  if (given.phantom) {  // its image is made by this program, in `out`
    claim_run_folder(out, files_of(given), clearable);
    return prepare(given, out);
  }
  keep_apart(out, files_of(given), clearable);
  PreparedCase prepared = prepare(given, out);
  refuse_outside(prepared);
  ask_for_the_frame(prepared);
  claim_run_folder(out, files_of(given), clearable);
  return prepared;
}

std::string finish(report::RunRecord& record, const PreparedCase& prepared, const fs::path& out,
                   std::chrono::steady_clock::time_point started) {
  const auto known = provenance(prepared, record);  // before what the caller adds
  record.provenance.insert(record.provenance.begin(), known.begin(), known.end());
  if (record.real_time) {  // two runs in lockstep are equal, whoever made them and when
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    record.provenance.emplace_back("made, UTC", fmt::format("{:%F %T}", now));
    record.provenance.emplace_back("operator", operator_name());
  }
  record.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  if (record.plan) atomic_write(out / "plan.mrk.json", planner::plan_markups(*record.plan));
  report::save_report(record, out);
  return report::console_table(record, isatty(STDOUT_FILENO) == 1) +
         fmt::format("\nreport: {}\n", (out / "report.html").string()) + export_plan(record, prepared, out);
}

}  // namespace biopsy::robot
