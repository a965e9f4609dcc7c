// What this program writes it reads back the same: plans, settings, models, data sets, records.
#include <cmath>

#include "drivers/commissioning/record.hpp"
#include "planner/plan/open_plan.hpp"
#include "planner/plan/seal.hpp"
#include "robot/console/review/run_table.hpp"
#include "robot/live/live_settings.hpp"
#include "robot/report/procedure/report.hpp"
#include "sim/plant/baseline_entries.hpp"
#include "sim/plant/dataset.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/model_text.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/verification/properties/property.hpp"

namespace biopsy::properties {
namespace {

int count() {
  return *rc::gen::inRange(0, 6);
}

Millimetres any_depth() {
  return Millimetres(any_number(-50.0, 50.0));
}

RC_GTEST_PROP(PlanFile, AnyPlanIsOpenedAsItWasSealed, ()) {
  Plan plan;
  plan.target = {any_text(), any_text(), Point(any_number(-1e3, 1e3), 0, 1),
                 Point(2, 3, any_number(-1e3, 1e3))};
  for (int n = count(); n > 0; --n) plan.layers.push_back({any_text(), any_depth(), any_depth()});
  for (int n = count(); n > 0; --n)
    plan.steps.push_back({static_cast<StepKind>(*rc::gen::inRange(0, 4)), any_depth(),
                          MillimetresPerSecond(1), Volts(any_number(0, 8e3)), Seconds(1),
                          *rc::gen::arbitrary<bool>(), any_text()});
  for (int n = count(); n > 0; --n)
    plan.limits.plausible.push_back({Volts(any_number(0, 8e3)), any_depth(), any_depth()});
  if (*rc::gen::arbitrary<bool>()) plan.bench = BenchDrive{Seconds(any_number(0.05, 2.5))};
  planner::seal(plan);
  const std::vector<std::uint8_t> bytes = planner::canonical_bytes(plan);
  const std::optional<Plan> opened = planner::open_plan(bytes, plan.seal);
  RC_ASSERT(opened.has_value());
  RC_ASSERT(planner::canonical_bytes(*opened) == bytes);
}

RC_GTEST_PROP(LiveSettingsFile, AnySettingsAreReadAsTheyWereWritten, ()) {
  live::LiveSettings settings;
  settings.domain = *rc::gen::inRange(0U, 231U);
  settings.network = any_text();
  settings.keys = any_text();
  settings.model = any_text();
  settings.weight_g = any_number(0.0, 1'000.0);
  settings.seed = *rc::gen::inRange<std::uint64_t>(0, INT64_MAX);
  for (int n = count(); n > 0; --n)
    settings.layers.push_back({any_text(), Millimetres(any_number(0, 1e3)), Millimetres(any_number(0, 1e3))});
  const std::string written = live::to_json(settings);
  const live::LiveSettings read = live::parse_settings(written, "live.json");
  RC_ASSERT(live::to_json(read) == written);
  RC_ASSERT(read.network == settings.network && read.keys == settings.keys);
  RC_ASSERT(read.seed == settings.seed && read.layers.size() == settings.layers.size());
}

RC_GTEST_PROP(ModelFile, AnyModelInItsRangesIsReadAsItWasWritten, ()) {
  sim::PlantModel model;
  sim::ModelNotes notes;
  notes.title = any_text();
  for (const sim::BaselineEntry& entry : sim::baseline_entries())
    if (entry.stack && *rc::gen::arbitrary<bool>()) {
      model.baseline.*entry.member = any_number(entry.low, entry.high);
      if (*rc::gen::arbitrary<bool>()) notes.values[std::string(entry.name)] = {any_number(0, 1), any_text()};
    }
  const std::string written = sim::model_toml(model, notes);
  const sim::NotedModel read = sim::parse_noted_model(written, "m.toml");
  for (const sim::BaselineEntry& entry : sim::baseline_entries())
    if (entry.stack) RC_ASSERT((read.model.baseline.*entry.member == model.baseline.*entry.member));
  RC_ASSERT(read.notes == notes);
}

RC_GTEST_PROP(DatasetFile, AnyRunIsReadWithinTheDigitsThatAreWritten, ()) {
  static const ScratchFolder folder;
  sim::Dataset dataset;
  dataset.title = any_text();
  sim::RecordedRun run;
  run.name = any_text();
  run.file = "a.csv";
  run.weight = any_number(0.0, 10.0);
  const int rows = *rc::gen::inRange(2, 40);
  for (int row = 0; row < rows; ++row) {
    run.time.push_back(1e-3 * row);
    run.input.push_back(any_number(-20e3, 20e3));
    run.displacement.push_back(any_number(-1e-2, 1e-2));
    run.current.push_back(any_number(-1e-3, 1e-3));
    run.external_force.push_back(any_number(-10, 10));
  }
  dataset.runs = {run};
  folder.write("dataset.toml", sim::dataset_toml(dataset));
  folder.write("a.csv", sim::run_csv(run, sim::Drive::Stack));
  const sim::Dataset read = sim::read_dataset(folder.path(), sim::Drive::Stack);
  RC_ASSERT(read.title == dataset.title && read.runs.size() == 1U && read.runs[0].name == run.name);
  for (std::size_t row = 0; row < run.time.size(); ++row) {
    RC_ASSERT(std::abs(read.runs[0].input[row] - run.input[row]) < 1e-4);
    RC_ASSERT(std::abs(read.runs[0].displacement[row] - run.displacement[row]) < 1e-9);
  }
  RC_ASSERT(sim::run_csv(read.runs[0], sim::Drive::Stack) == sim::run_csv(run, sim::Drive::Stack));
}

RC_GTEST_PROP(RunFile, AnyRunIsReadWithinTheDigitsThatAreWritten, ()) {
  report::RunRecord record;
  record.simulated = *rc::gen::arbitrary<bool>();
  double time_ms = 0.0;
  for (int n = *rc::gen::inRange(1, 40); n > 0; --n) {
    report::Sample sample;
    sample.time_ms = time_ms += any_number(0.0, 20.0);
    sample.depth_mm = static_cast<float>(any_number(-50.0, 50.0));
    sample.setpoint_mm = static_cast<float>(any_number(0.0, 50.0));
    sample.tip_mm = static_cast<float>(any_number(-50.0, 50.0));
    sample.drive_kV = static_cast<float>(any_number(-8.0, 8.0));
    sample.current_uA = static_cast<float>(any_number(-300.0, 300.0));
    sample.mode = static_cast<Mode>(*rc::gen::inRange(0, 9));
    sample.stop = static_cast<StopCategory>(*rc::gen::inRange(0, 4));
    sample.step = *rc::gen::inRange<std::uint8_t>(0, 20);
    sample.verdict = static_cast<GateVerdict>(*rc::gen::inRange(0, 11));
    sample.locked = *rc::gen::arbitrary<bool>();
    record.samples.push_back(sample);
  }
  const console::RunTable read = console::parse_run_table(report::run_csv(record), "run.csv");
  RC_ASSERT(read.columns.size() == (record.simulated ? 10U : 8U));
  std::size_t span = 0;
  for (std::size_t k = 0; k < record.samples.size(); ++k) {
    const report::Sample& sample = record.samples[k];
    RC_ASSERT(std::abs(read.values[0][k] - 1e-3 * sample.time_ms) < 1e-6);
    RC_ASSERT(std::abs(read.values[1][k] - sample.depth_mm) < 1e-5);  // after time in the table of columns
    RC_ASSERT(std::abs(read.values[3][k] - 1e3 * sample.drive_kV) < 1e-3);
    RC_ASSERT(read.values.back()[k] == (sample.locked ? 1.0 : 0.0));
    while (span + 1 < read.spans.size() && read.spans[span + 1].from <= read.values[0][k] &&
           (read.spans[span].mode != sample.mode || read.spans[span].stop != sample.stop ||
            read.spans[span].step != sample.step + 1U))
      ++span;
    RC_ASSERT(read.spans[span].mode == sample.mode && read.spans[span].stop == sample.stop);
    RC_ASSERT(read.spans[span].step == sample.step + 1U);
  }
}

RC_GTEST_PROP(CommissioningFile, AnyRecordIsReadAsItWasWritten, ()) {
  commissioning::Record record;
  record.device = {any_text(), any_text(), *rc::gen::arbitrary<std::uint32_t>()};
  record.config_sha256 = any_text();
  record.software = any_text();
  record.made_unix_s = *rc::gen::inRange<std::int64_t>(0, 4'000'000'000);
  for (int n = count(); n > 0; --n) {
    commissioning::StepRecord step{any_text(), {}, any_text()};
    for (int m = count(); m > 0; --m)
      step.figures.push_back(
          {any_text(), any_text(), any_number(-1e6, 1e6), any_number(-1, 1), any_number(-1, 1), ""});
    record.steps.push_back(step);
  }
  const std::string written = commissioning::to_json(record);
  RC_ASSERT(commissioning::to_json(commissioning::from_json(written, "record")) == written);
}

}  // namespace
}  // namespace biopsy::properties
