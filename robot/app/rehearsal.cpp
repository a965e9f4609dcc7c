#include "robot/app/rehearsal.hpp"

#include <fmt/format.h>

#include <cmath>

#include "planner/imaging/depth_check.hpp"
#include "planner/imaging/read_volume.hpp"
#include "planner/seal.hpp"
#include "robot/app/operator.hpp"
#include "robot/app/plan_facts.hpp"
#include "robot/app/run_metrics.hpp"
#include "robot/app/side_letters.hpp"
#include "sim/devices/sim_stage.hpp"
#include "sim/model_file.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/scanner.hpp"
#include "sim/seeded_noise.hpp"
#include "sim/tissue/tissue.hpp"

namespace biopsy::app {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kTicksMax = 600'000;  // ten minutes: no procedure of this robot takes longer
constexpr std::uint64_t kMotionStream = 0x6d6f7665;
constexpr std::int64_t kProgressEvery = 1000;

sim::PlantModel plant_of(const PreparedCase& prepared) {
  const Case& given = prepared.given;
  sim::PlantModel model = sim::read_model(given.rehearsal.model);
  model.tissue = sim::tissue_along(prepared.layers, sim::read_tissues(given.rehearsal.tissues));
  model.weight = given.weight.value * 1e-3;
  return model;
}

// The patient's position at image number `image`: uniform within the case's bounds, drawn from the seed.
sim::PatientMotion motion_at(const Case& given, const Point& about, std::uint64_t image) {
  const auto draw = [&](std::uint64_t axis) {
    return 2.0 * sim::uniform(given.seed ^ kMotionStream, 6 * image + axis) - 1.0;
  };
  const double scale = 1.0 / std::sqrt(3.0);  // the bound holds for the length, not for each axis
  sim::PatientMotion motion;
  motion.about = about;
  motion.shift_mm = given.rehearsal.motion_mm * scale * Eigen::Vector3d(draw(0), draw(1), draw(2));
  motion.rotation_deg = given.rehearsal.motion_deg * scale * Eigen::Vector3d(draw(3), draw(4), draw(5));
  return motion;
}

report::SliceGeometry geometry_of(const imaging::NeedleSlice& slice) {
  // The report counts pixels from the corner of the first one, the slice from its centre.
  report::SliceGeometry geometry{slice.entry_px.x() + 0.5, slice.entry_px.y() + 0.5, slice.axis_px.x(),
                                 slice.axis_px.y(), slice.mm_per_pixel};
  const Direction right_S = slice.axis_px.x() * slice.frame.along + slice.across_px.x() * slice.frame.across;
  const Direction down_S = slice.axis_px.y() * slice.frame.along + slice.across_px.y() * slice.frame.across;
  geometry.right = side_letters(right_S);
  geometry.left = side_letters(-right_S);
  geometry.bottom = side_letters(down_S);
  geometry.top = side_letters(-down_S);
  return geometry;
}

// The scanner's part of a rehearsal: takes an image of the needle where it truly is, sends it as DICOM, and
// has the depth check read what was sent.
class ImageCheck {
 public:
  ImageCheck(const PreparedCase& prepared, const Plan& plan, fs::path folder)
      : prepared_(prepared), plan_(plan), folder_(std::move(folder)) {}

  void take(std::size_t stage, Millimetres tip, report::StageResult& result) {
    const std::string name = fmt::format("images/stage-{}", stage + 1);
    sim::ScanSettings settings;
    const Point p_SE = plan_.X_SR.translation();
    const Direction axis_S = plan_.X_SR.linear().col(2);
    settings.needle = sim::NeedleArtefact{.p_SE = p_SE, .axis_S = axis_S, .tip_depth = tip};
    settings.motion = motion_at(prepared_.given, p_SE, stage);
    settings.snr = prepared_.given.rehearsal.snr;
    settings.seed = prepared_.given.seed + 1000 * (stage + 1);
    Volume sent = sim::scan(prepared_.image, settings);
    sent.identity.series_uid.clear();  // a new series; the writer names it by its content
    sent.identity.description = fmt::format("confirmation, stage {} (simulated)", stage + 1);
    sim::write_dicom_series(sent, folder_ / name);
    const Volume after = imaging::read_volume(folder_ / name);
    imaging::DepthCheckSettings check;
    check.expected = plan_.stages[stage].depth;
    imaging::DepthCheckPictures pictures;
    result.check = imaging::check_depth(prepared_.image, after, p_SE, axis_S, check, &pictures);
    result.image_path = name;
    result.before = pictures.before.picture;
    result.after = pictures.after.picture;
    if (pictures.after.picture.width > 0) result.geometry = geometry_of(pictures.after);
  }

 private:
  const PreparedCase& prepared_;
  const Plan& plan_;
  fs::path folder_;
};

report::Sample sample_of(const Tick& tick, const sim::SimStage& stage, const sim::PlantState& before,
                         Millimetres setpoint, std::int64_t number) {
  report::Sample sample;
  sample.time_ms = static_cast<std::int32_t>(number);
  sample.setpoint_mm = static_cast<float>(setpoint.value);
  sample.depth_mm = static_cast<float>(tick.measurement.depth_um * 1e-3);
  sample.tip_mm = static_cast<float>(before.motion.x * 1e3);
  sample.plate_b_mm = static_cast<float>(sim::plate_b(stage.model(), before) * 1e3);
  sample.drive_kV = static_cast<float>(tick.drive_mV * 1e-6);
  sample.envelope_kV = static_cast<float>(tick.supervisor.permit.v_max_mV * 1e-6);
  sample.monitor_kV = static_cast<float>(tick.measurement.monitor_mV * 1e-6);
  sample.current_uA = static_cast<float>(tick.measurement.current_nA * 1e-3);
  sample.mode = tick.supervisor.permit.mode;
  sample.stop = tick.supervisor.permit.stop;
  sample.stage = static_cast<std::uint8_t>(tick.supervisor.stage);
  sample.verdict = tick.measurement.verdict;
  return sample;
}

void note_trips(const Tick& tick, Mode before, std::int64_t number, report::RunRecord& record) {
  const Mode now = tick.supervisor.permit.mode;
  const bool unasked = now == Mode::Trip || now == Mode::Lock ||
                       (now == Mode::Retract && tick.supervisor.reason != safety::Hazard::None) ||
                       (now == Mode::Hold && tick.supervisor.reason != safety::Hazard::None);
  if (now == before || !unasked) return;
  record.trips.push_back({static_cast<double>(number) * 1e-3, tick.supervisor.permit.stop,
                          std::string(safety::name_of(tick.supervisor.reason))});
}

// Layer the tip is in: the deepest one whose surface gave way and that begins ahead of the tip.
std::string layer_at(const Plan& plan, const sim::PlantModel& model, const sim::PlantState& state) {
  const int entered = sim::layers_entered(model, state);
  std::string name = "outside";
  for (int i = 0; i < entered && i < static_cast<int>(plan.layers.size()); ++i)
    if (state.motion.x * 1e3 >= plan.layers[static_cast<std::size_t>(i)].from.value)
      name = plan.layers[static_cast<std::size_t>(i)].name;
  return name;
}

void draw_planning_slice(const PreparedCase& prepared, const Plan& plan, report::RunRecord& record) {
  constexpr Millimetres kExtent{80.0};
  constexpr int kSize_px = 640;
  const imaging::NeedleSlice slice =
      imaging::slice_through_needle(prepared.image, plan.X_SR.translation(), plan.X_SR.linear().col(2),
                                    prepared.given.phantom ? Millimetres(30.0) : kExtent, kSize_px);
  record.planning_slice = slice.picture;
  record.planning_geometry = geometry_of(slice);
}

}  // namespace

report::RunRecord planned_record(const PreparedCase& prepared) {
  report::RunRecord record;
  record.title = prepared.given.title;
  record.series = prepared.image.identity;
  record.image_source = prepared.given.phantom ? "built-in phantom" : prepared.given.image.string();
  record.image_warnings = prepared.image.warnings;
  record.seed = prepared.given.seed;
  if (const auto* refusal = std::get_if<PlanRefusal>(&prepared.plan)) {
    record.outcome = report::Outcome::Refused;
    record.refusal = refusal->what;
    record.remedy = refusal->remedy;
    return record;
  }
  const Plan& plan = std::get<Plan>(prepared.plan);
  record.plan = plan;
  record.outcome = report::Outcome::Stopped;
  draw_planning_slice(prepared, plan, record);
  for (const Stage& stage : plan.stages) {
    record.stages.emplace_back();
    record.stages.back().stage = stage;
  }
  return record;
}

report::RunRecord rehearse(const PreparedCase& prepared, const fs::path& folder, const Progress& progress) {
  report::RunRecord record = planned_record(prepared);
  const Plan& plan = std::get<Plan>(prepared.plan);
  const safety::PlanFacts facts = plan_facts(plan, 1 + prepared.given.seed);
  sim::SimStage stage(plant_of(prepared), prepared.given.seed);
  const std::uint64_t shown =
      planner::plan_tag(plan);  // what both people of the rehearsal were shown and confirm
  Lockstep lockstep(plan, facts, stage, {shown, shown});
  Operator person(plan);
  ImageCheck images(prepared, plan, folder);
  Tick seen;
  double tip_sum_mm = 0.0;  // while the image is taken
  std::int64_t tip_count = 0;
  for (std::int64_t number = 0; number < kTicksMax && !person.done(); ++number) {
    const World world = person.act(seen, number);
    if (person.wants_verdict()) {
      report::StageResult& result = record.stages[world.accepted_stage];
      progress(static_cast<double>(number) * 1e-3,
               fmt::format("checking the image of stage {}", world.accepted_stage + 1));
      images.take(world.accepted_stage, Millimetres(tip_sum_mm / static_cast<double>(tip_count)), result);
      person.judge(result.check->verdict == DepthVerdict::Accept, "depth check: " + result.check->reason);
      tip_sum_mm = 0.0, tip_count = 0;
    }
    const sim::PlantState before = stage.truth();
    const Mode mode_before = seen.supervisor.permit.mode;
    seen = lockstep.tick(world);
    record.samples.push_back(sample_of(seen, stage, before, lockstep.controller().setpoint, number));
    note_trips(seen, mode_before, number, record);
    report::StageResult& result = record.stages[seen.supervisor.stage];
    if (seen.supervisor.stage_done && !result.reached) {
      result.reached = true;
      result.reached_s = static_cast<double>(number) * 1e-3;
      result.layer_at_tip = layer_at(plan, stage.model(), before);
    }
    if (world.acquiring) {
      if (tip_count == 0) result.image_s = static_cast<double>(number) * 1e-3;
      tip_sum_mm += before.motion.x * 1e3;
      ++tip_count;
      result.hv_switching_during_image = result.hv_switching_during_image || seen.supervisor.image_disturbed;
    }
    if (number % kProgressEvery == 0)
      progress(lockstep.controller().setpoint / plan.target_depth,
               fmt::format("rehearsing: {:.0f} s, {}, {:.2f} mm", static_cast<double>(number) * 1e-3,
                           safety::name_of(seen.supervisor.permit.mode), seen.measurement.depth_um * 1e-3));
  }
  record.outcome = person.completed() ? report::Outcome::Completed : report::Outcome::Stopped;
  record.refusal = person.completed() ? "" : person.stopped_because();
  record.simulated_s = static_cast<double>(record.samples.size()) * 1e-3;
  measure_run(record);
  return record;
}

}  // namespace biopsy::app
