#include "robot/procedure/rehearsal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>

#include "planner/imaging/registration/reslice.hpp"
#include "planner/imaging/views/plane_views.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/procedure/fault_notes.hpp"
#include "robot/procedure/images/anatomical_orientation.hpp"
#include "robot/procedure/images/confirmation_image.hpp"
#include "robot/procedure/images/patient_motion.hpp"
#include "robot/procedure/images/slice_geometry.hpp"
#include "robot/procedure/link_faults.hpp"
#include "robot/procedure/operator.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "robot/procedure/run_metrics.hpp"
#include "robot/procedure/run_notes.hpp"
#include "sim/faults/faulty_stage.hpp"
#include "sim/simulated_stage.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kTicksMax = 3'600'000;  // an hour: no procedure of this robot takes longer
constexpr std::int64_t kProgressEvery = 1000;

Truth truth_of(const sim::SimulatedStage& step) {
  const sim::PlantState& state = step.truth();
  return {state.motion.x * 1e3, sim::plate_b(step.model(), state) * 1e3,
          sim::layers_entered(step.model(), state)};
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

void draw_planes(const PreparedCase& prepared, const Plan& plan, report::RunRecord& record) {
  const Point p_SE = plan.target.p_SE, p_ST = plan.target.p_ST;
  const Millimetres extent{std::clamp(4.0 * (p_ST - p_SE).norm(), 40.0, 240.0)};
  for (const imaging::PlaneView& view : imaging::plane_views(prepared.image, p_ST, extent)) {
    const Eigen::Vector2d entry = view.pixel(p_SE), target = view.pixel(p_ST);
    report::BodyPlane plane;
    plane.name = view.name;
    plane.place = view.coordinate() +
                  (view.slice > 0 ? fmt::format(", slice {} of {}", view.slice, view.slices) : ", resliced");
    plane.window = fmt::format("black {:.0f}, white {:.0f}", view.window.black, view.window.white);
    plane.picture = view.picture;
    plane.entry_px = {entry.x(), entry.y()}, plane.target_px = {target.x(), target.y()};
    plane.right = anatomical_directions(view.right_S), plane.left = anatomical_directions(-view.right_S);
    plane.bottom = anatomical_directions(view.down_S), plane.top = anatomical_directions(-view.down_S);
    record.planes.push_back(std::move(plane));
  }
}

}  // namespace

report::RunRecord planned_record(const PreparedCase& prepared) {
  report::RunRecord record;
  record.title = prepared.given.title;
  record.series = prepared.image.identity;
  record.image_source = prepared.given.phantom ? "built-in phantom" : prepared.given.image.string();
  record.image_warnings = prepared.image.warnings;
  record.image_warnings.insert(record.image_warnings.end(), prepared.plan_warnings.begin(),
                               prepared.plan_warnings.end());
  record.registration = !prepared.given.fiducials.empty() ? "registered"
                        : prepared.given.transform        ? "given"
                                                          : "assumed";
  record.seed = prepared.given.seed;
  record.simulated_s = 0.0;
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
  draw_planes(prepared, plan, record);
  for (const InsertionStep& step : plan.steps) {
    record.steps.emplace_back();
    record.steps.back().step = step;
  }
  return record;
}

namespace {

// A scanner's image is waited for while the ticks go on; a simulated one is taken at once, between two ticks.
std::future<report::StepResult> begin_check(ConfirmationImages& images, std::size_t step, Millimetres tip,
                                            Seconds scan, report::StepResult result) {
  const auto policy = images.from_scanner() ? std::launch::async : std::launch::deferred;
  return std::async(policy, [&images, step, tip, scan, result = std::move(result)]() mutable {
    if (images.from_scanner()) realtime::run_in_background();
    images.take(step, tip, std::chrono::round<std::chrono::milliseconds>(scan), result);
    return std::move(result);
  });
}

// An image that was disturbed is none to accept, whatever it shows: it is taken again, as an unsure one is.
// On a stage without a brake every image is: its loop is rehearsed all the same, and the report says so.
std::pair<DepthVerdict, std::string> judgement_of(const report::StepResult& result,
                                                  const Rehearsal& rehearsal, bool brake_fitted) {
  const bool counts = brake_fitted && !rehearsal.accept_unseen;
  if (result.check->verdict == DepthVerdict::Accept && result.hv_switching_during_image && counts)
    return {DepthVerdict::Unsure, "the drive switched, or the needle slipped, while the image was taken"};
  return {result.check->verdict, "depth check: " + result.check->reason};
}

}  // namespace

report::RunRecord rehearse_on(const Robot& robot, const PreparedCase& prepared, const fs::path& folder,
                              const Progress& progress, const std::stop_token& stop) {
  const Plan& plan = std::get<Plan>(prepared.plan);
  RunNotes notes(prepared);
  report::RunRecord& record = notes.record();
  Operator person(plan, prepared.given.rehearsal.scan);
  ConfirmationImages images(prepared, plan, folder);
  std::future<report::StepResult> check;  // of an image that is being taken
  OperatorInputs inputs;
  std::int32_t motion_um = 0;
  CycleSample cycle;
  for (std::int64_t number = 0; number < kTicksMax && !person.done(); ++number) {
    // While an image is checked ticks queue up; the operator acts on the newest only.
    if (cycle.newest && !check.valid()) inputs = person.act(cycle.record, number);
    if (person.wants_verdict() && !check.valid()) {
      progress(cycle.setpoint / plan.target_depth,
               fmt::format("checking the image of step {}", inputs.accepted_step + 1));
      const Seconds scan = scan_time(cycle.record.measurement.brake_fitted, prepared.given.rehearsal.scan);
      check = begin_check(images, inputs.accepted_step, notes.take_imaged_tip(), scan,
                          record.steps[inputs.accepted_step]);
    }
    if (check.valid() && check.wait_for(std::chrono::seconds(0)) != std::future_status::timeout) {
      report::StepResult& result = record.steps[inputs.accepted_step];
      const bool disturbed = result.hv_switching_during_image;  // while a scanner's image was waited for, too
      result = check.get();
      result.hv_switching_during_image = disturbed;
      note_patient_motion(*result.check, motion_um);
      const auto [verdict, why] =
          judgement_of(result, prepared.given.rehearsal, cycle.record.measurement.brake_fitted);
      person.judge(verdict, why, motion_um);
      inputs.acquiring = false;
    }
    if (stop.stop_requested()) {
      record.refusal = "interrupted";
      break;
    }
    const std::optional<CycleSample> next = robot(inputs);
    if (!next) {
      record.refusal = "no tick from the stage for a second";
      break;
    }
    cycle = *next;
    person.observe(cycle.record);
    notes.add(cycle, inputs);
    if (number % kProgressEvery == 0)
      progress(cycle.setpoint / plan.target_depth,
               fmt::format("rehearsing: {:.0f} s, {}, {}", static_cast<double>(number) * 1e-3,
                           safety::name_of(cycle.record.supervisor.permit.mode),
                           fixed(cycle.record.measurement.depth_um * 1e-3, 2, "mm")));
  }
  if (!person.done() && record.refusal.empty()) record.refusal = "the procedure was not over after an hour";
  images.cancel();
  record.outcome = person.completed() ? report::Outcome::Completed : report::Outcome::Stopped;
  if (record.refusal.empty()) record.refusal = person.completed() ? "" : person.stopped_because();
  if (!record.trips.empty() && record.trips.back().reason == name_of(safety::Event::HoldTooLong))
    record.remedy =
        "a hold lasts 10 s, and longer only while the brake locks the needle and it stands still: see in "
        "run.csv "
        "(locked, depth) whether it gripped";
  measure_run(record);
  return record;
}

report::RunRecord rehearse(const PreparedCase& prepared, const fs::path& folder, const Progress& progress,
                           const std::stop_token& stop, const std::vector<sim::Fault>& faults) {
  const Plan& plan = std::get<Plan>(prepared.plan);
  const Case& given = prepared.given;
  const safety::PlanFacts facts = robot::plan_facts(plan, 1 + given.seed);
  sim::SimulatedStage step(
      rehearsed_plant(given.rehearsal.model, given.rehearsal.tissues, prepared.layers, given.weight.value),
      given.seed);
  // What both people of the rehearsal were shown and confirm.
  const std::uint64_t shown = planner::plan_tag(plan);
  sim::FaultyStage faulty(step, faults, given.seed);
  LinkFaults links(faulty, given.seed);
  SimulatedRobot lockstep(plan, facts, faulty, {shown, shown});
  lockstep.wrap(links);
  FaultNotes notes(faults);
  const Robot robot = [&](const OperatorInputs& inputs) {
    CycleSample cycle;
    cycle.truth = truth_of(step);
    cycle.record = lockstep.run_cycle(inputs);
    cycle.truth.active_faults = faulty.active_faults();
    notes.add(cycle.record, cycle.truth.active_faults);
    cycle.setpoint = lockstep.controller().setpoint;
    return std::optional<CycleSample>(cycle);
  };
  report::RunRecord record = rehearse_on(robot, prepared, folder, progress, stop);
  notes.finish(record);
  return record;
}

}  // namespace biopsy::robot
