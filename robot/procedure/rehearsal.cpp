#include "robot/procedure/rehearsal.hpp"

#include <fmt/format.h>

#include <future>

#include "planner/imaging/registration/reslice.hpp"
#include "planner/plan/seal.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/procedure/fault_notes.hpp"
#include "robot/procedure/images/confirmation_image.hpp"
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

constexpr std::int64_t kTicksMax = 600'000;  // ten minutes: no procedure of this robot takes longer
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

}  // namespace

report::RunRecord planned_record(const PreparedCase& prepared) {
  report::RunRecord record;
  record.title = prepared.given.title;
  record.series = prepared.image.identity;
  record.image_source = prepared.given.phantom ? "built-in phantom" : prepared.given.image.string();
  record.image_warnings = prepared.image.warnings;
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
  for (const InsertionStep& step : plan.steps) {
    record.steps.emplace_back();
    record.steps.back().step = step;
  }
  return record;
}

namespace {

// A scanner's image is waited for while the ticks go on; a simulated one is taken at once, between two ticks.
std::future<report::StepResult> begin_check(ConfirmationImages& images, std::size_t step, Millimetres tip,
                                            report::StepResult result) {
  const auto policy = images.from_scanner() ? std::launch::async : std::launch::deferred;
  return std::async(policy, [&images, step, tip, result = std::move(result)]() mutable {
    images.take(step, tip, std::chrono::milliseconds(kAcquisition_ticks), result);
    return std::move(result);
  });
}

}  // namespace

report::RunRecord rehearse_on(const Robot& robot, const PreparedCase& prepared, const fs::path& folder,
                              const Progress& progress, const std::stop_token& stop) {
  const Plan& plan = std::get<Plan>(prepared.plan);
  RunNotes notes(prepared);
  report::RunRecord& record = notes.record();
  Operator person(plan);
  ConfirmationImages images(prepared, plan, folder);
  std::future<report::StepResult> check;  // of an image that is being taken
  OperatorInputs inputs;
  CycleSample cycle;
  for (std::int64_t number = 0; number < kTicksMax && !person.done(); ++number) {
    // While an image is checked ticks queue up; the operator acts on the newest only.
    if (cycle.newest && !check.valid()) inputs = person.act(cycle.record, number);
    if (person.wants_verdict() && !check.valid()) {
      progress(cycle.setpoint / plan.target_depth,
               fmt::format("checking the image of step {}", inputs.accepted_step + 1));
      check = begin_check(images, inputs.accepted_step, notes.take_imaged_tip(),
                          record.steps[inputs.accepted_step]);
    }
    if (check.valid() && check.wait_for(std::chrono::seconds(0)) != std::future_status::timeout) {
      report::StepResult& result = record.steps[inputs.accepted_step];
      result = check.get();
      person.judge(result.check->verdict, "depth check: " + result.check->reason);
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
  images.cancel();
  record.outcome = person.completed() ? report::Outcome::Completed : report::Outcome::Stopped;
  if (record.refusal.empty()) record.refusal = person.completed() ? "" : person.stopped_because();
  record.simulated_s = static_cast<double>(record.samples.size()) * 1e-3;
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
