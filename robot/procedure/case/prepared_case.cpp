#include "robot/procedure/case/prepared_case.hpp"

#include <fmt/format.h>

#include "planner/imaging/io/labels.hpp"
#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/io/series_list.hpp"
#include "planner/plan/fiducial_file.hpp"
#include "planner/plan/plan_insertion.hpp"
#include "planner/plan/registration.hpp"
#include "robot/common/config_error.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/plan_facts.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/phantom.hpp"

namespace biopsy::robot {
namespace {

// Layers are looked up a little further than any plan can reach, so that the tissue behind the target is
// known too.
constexpr Millimetres kBeyond{2.0};
// An overshoot of the whole plan that the supervisor ends; layers must be known that far.
constexpr Millimetres kMargin = from_um(limits::kDepthHard_um);

struct Pose {
  RigidTransform X_SR = RigidTransform::Identity();
  double fre_mm = 0.0, tre_mm = 0.0;
};

// Where the robot is: by fiducials, by a given transform, or, with neither, where the guide was aimed: at the
// entry, pointing at the target.
std::variant<Pose, PlanRefusal> pose_of(const Case& given, const Target& target) {
  if (!given.fiducials.empty()) {
    const auto result = planner::register_robot(planner::read_fiducials(given.fiducials));
    if (const auto* refusal = std::get_if<PlanRefusal>(&result)) return *refusal;
    const auto& registration = std::get<planner::Registration>(result);
    return Pose{registration.X_SR, registration.fre_mm, planner::expected_tre_mm(registration, target.p_ST)};
  }
  if (given.transform) {
    std::array<double, 16> rows{};
    std::copy(given.transform->begin(), given.transform->end(), rows.begin());
    return Pose{planner::rigid_transform_from_ras(rows, "transform_ras")};
  }
  return Pose{planner::needle_pose(target.p_SE, target.p_ST)};
}

// Layers along the way from the entry to the target and a little beyond.
std::vector<Layer> layers_of(const Case& given, const Volume* labels, const planner::LabelNames& names,
                             const Target& target) {
  if (!given.layers.empty()) return given.layers;
  const Millimetres length = Millimetres((target.p_ST - target.p_SE).norm()) + kMargin + kBeyond;
  if (labels != nullptr)
    return planner::layers_along_path(*labels, target.p_SE, (target.p_ST - target.p_SE).normalized(), length,
                                      names);
  return {{"unknown", Millimetres(0), length}};
}

// What both files say of patient and frame of reference must agree.
void check_labels_belong(const SeriesIdentity& image, const SeriesIdentity& labels) {
  const auto refuse = [](const std::string& what) {
    throw ConfigError("the label map " + what, "labels", "give the label map that was drawn on this image");
  };
  if (stated_otherwise(image.patient_id, labels.patient_id)) refuse("is of another patient than the image");
  if (stated_otherwise(image.frame_of_reference_uid, labels.frame_of_reference_uid))
    refuse("lies in another frame of reference than the image");
}

// Where nothing names a series, a person at the console begins with the first that can be read.
std::string series_to_open(const Case& given) {
  if (!given.series_uid.empty() || has_points(given)) return given.series_uid;
  for (const imaging::SeriesSummary& found : imaging::list_series(given.image))
    if (found.problem.empty()) return found.series_uid;
  return {};
}

}  // namespace

PreparedCase open_case(const Case& given, const std::filesystem::path& folder) {
  PreparedCase out{
      given, {}, {}, {}, PlanRefusal{"no points are set", "set entry and target"}, {}, given.label_names};
  if (given.phantom) {
    sim::Phantom phantom = sim::paper_phantom();
    sim::write_dicom_series(phantom.image, folder / "planning");
    out.image = imaging::read_volume(folder / "planning");
    out.target.p_SE = phantom.p_SE;
    out.target.p_ST = phantom.p_SE + given.depth.value_or(Millimetres(0)).value * phantom.axis_S;
    out.labels = std::move(phantom.labels);
    for (std::size_t i = 0; i < phantom.names.size(); ++i)
      out.label_names[static_cast<int>(i)] = phantom.names[i];
  } else {
    out.image = imaging::read_volume(given.image, series_to_open(given));
    out.target.p_SE = given.p_SE.value_or(Point::Zero());
    out.target.p_ST = given.p_ST.value_or(Point::Zero());
    if (!given.labels.empty()) {
      imaging::LabelMap map = imaging::read_labels(given.labels, given.labels_anyway);
      check_labels_belong(out.image.identity, map.volume.identity);
      imaging::cover_image(out.image.grid, map);
      out.labels = std::move(map.volume);
      out.label_names.merge(map.names);  // the case's come first
      for (const std::string& warning : out.labels->warnings)
        out.image.warnings.push_back("label map: " + warning);
    }
  }
  out.target.patient_id = out.image.identity.patient_id;
  out.target.series_uid = out.image.identity.series_uid;
  return out;
}

namespace {

// Tissue that nobody named is planned through as "unknown": a person must know.
std::vector<std::string> warnings_of_layers(const std::vector<Layer>& layers, bool labelled) {
  double unlabelled_mm = 0.0;
  for (const Layer& layer : layers)
    if (layer.name == "unlabelled") unlabelled_mm += (layer.to - layer.from).value;
  if (!labelled || unlabelled_mm <= 0.0) return {};
  return {fmt::format("{:.1f} mm of the needle's path and of the margin behind the target have no label",
                      unlabelled_mm)};
}

// What the supervisor would refuse (H-20) is said before anybody confirms it. The planner keeps its other
// bounds by itself; how deep this stage could be at a drive comes from the stage's model.
std::optional<PlanRefusal> objection_of_supervisor(const Plan& plan) {
  const safety::PlanFacts facts = plan_facts(plan, 1);
  if (safety::is_plausible(facts)) return std::nullopt;
  const safety::PlausibleBand& last = facts.bands[facts.band_count - 1];
  return PlanRefusal{
      fmt::format(
          "the supervisor would refuse this plan (H-20): by its model this stage is none of this kind. "
          "Its needle may be {:.1f} mm deep at 0 V (at most 5.0) and {:.1f} mm at {:.1f} kV (21.0), and "
          "lifts from {:.1f} kV on (4.0)",
          facts.bands[0].high_um * 1e-3, last.high_um * 1e-3, last.drive_mV * 1e-6,
          safety::lifting_drive_mV(facts) * 1e-6),
      "give a model of the stage as it is (biopsy calibrate); a stage that is so needs service"};
}

}  // namespace

void plan_to_target(PreparedCase& out) {
  const Case& given = out.given;
  out.layers = layers_of(given, out.labels ? &*out.labels : nullptr, out.label_names, out.target);
  out.plan_warnings = warnings_of_layers(out.layers, out.labels.has_value() && given.layers.empty());
  const auto pose = pose_of(given, out.target);
  if (const auto* refusal = std::get_if<PlanRefusal>(&pose)) {
    out.plan = *refusal;
    return;
  }
  planner::InsertionRequest request;
  request.target = out.target;
  request.X_SR = std::get<Pose>(pose).X_SR;
  request.registration_fre_mm = std::get<Pose>(pose).fre_mm;
  request.registration_tre_mm = std::get<Pose>(pose).tre_mm;
  request.layers = out.layers;
  request.weight = given.weight;
  request.stage = planner::read_nominal_stage(given.rehearsal.model);
  request.waypoints = given.waypoints;
  request.staging = given.staging;
  request.pace = given.pace;
  request.gains = given.gains;
  request.tip_offset = given.tip_offset;
  out.plan = planner::plan_insertion(request);
  const Plan* plan = std::get_if<Plan>(&out.plan);
  if (plan == nullptr) return;
  if (const auto refusal = objection_of_supervisor(*plan)) out.plan = *refusal;
}

PreparedCase prepare(const Case& given, const std::filesystem::path& folder) {
  PreparedCase out = open_case(given, folder);
  if (has_points(given))
    plan_to_target(out);
  else
    out.layers = {{"unknown", Millimetres(0), kMargin + kBeyond}};
  return out;
}

}  // namespace biopsy::robot
