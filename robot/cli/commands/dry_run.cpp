// biopsy dry-run and biopsy plan.
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "drivers/needle_stage_factory.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/logging/log_session.hpp"
#include "robot/common/logging/logger.hpp"
#include "robot/common/progress.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/procedure/fault_notes.hpp"
#include "robot/procedure/operator.hpp"
#include "robot/procedure/procedure.hpp"
#include "robot/procedure/provenance.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/report/procedure/report.hpp"
#include "sim/faults/fault_file.hpp"

namespace biopsy::robot {
namespace dry_run_cli {

using Clock = std::chrono::steady_clock;

struct Options {
  ProcedureOptions procedure;
  bool live = false;
  std::filesystem::path faults;
  LiveOptions network;
};

void declare_dry_run(CLI::App& app, Options& options) {
  add_procedure_options(app, options.procedure);
  CLI::Option* live = app.add_flag(
      "--live", options.live,
      "through the [live robot's](../how-to/live.md) processes over DDS, in real time, instead of one "
      "virtual clock");
  add(app, "--faults FILE", options.faults,
      "put [faults](faults.md) into sensors and drive of the simulated stage and, without `--live`, links "
      "and "
      "contacts");
  add_image_source(app, options.procedure, live);
  add_live_options(app, options.network, live);
}

Result finished(report::RunRecord& record, const PreparedCase& prepared, const std::filesystem::path& out,
                Clock::time_point started) {
  std::string text = finish(record, prepared, out, started);
  return {.exit_code = record.outcome == report::Outcome::Completed ? 0 : 3,
          .text = std::move(text),
          .json = report::report_json(record)};
}

std::string fault_lines(const report::RunRecord& record) {
  if (record.faults.empty()) return {};
  std::string text = fmt::format("true depth at most {}\n", fixed(record.true_depth_max_mm, 2, "mm"));
  for (const report::FaultResult& fault : record.faults) {
    if (std::isnan(fault.began_s))
      text += fmt::format("fault {} {}: never began\n", fault.signal, fault.kind);
    else if (fault.detected_by.empty())
      text +=
          fmt::format("fault {} {}: from {:.3f} s, not detected\n", fault.signal, fault.kind, fault.began_s);
    else
      text += fmt::format("fault {} {}: from {:.3f} s, detected after {:.0f} ms by {}\n", fault.signal,
                          fault.kind, fault.began_s, fault.detected_after_ms, fault.detected_by);
  }
  return text;
}

Result in_lockstep(const PreparedCase& prepared, const std::filesystem::path& out,
                   const std::vector<sim::Fault>& faults, const std::filesystem::path& faults_file,
                   const Context& context, Clock::time_point started) {
  report::RunRecord record;
  {
    ProgressLine line;
    record = rehearse(
        prepared, out, [&line](double share, const std::string& what) { line.show(share, what); },
        context.interrupted, faults);
  }
  record.provenance = provenance_of_faults(faults_file);
  Result result = finished(record, prepared, out, started);
  result.text += fault_lines(record);
  return result;
}

// Links and contacts of live processes are real.
void refuse_beyond_stage(const std::vector<sim::Fault>& faults, const std::filesystem::path& file) {
  for (const sim::Fault& fault : faults)
    if (is_link(fault.signal) || is_contact(fault.signal))
      throw ConfigError(fmt::format("a fault of {} cannot be put into live processes", name_of(fault.signal)),
                        file.string(),
                        "leave out --live, or give faults of depth, depth_b, voltage_monitor, "
                        "current_monitor, drive or brake");
}

Result through_processes(const PreparedCase& prepared, const Options& options,
                         const std::vector<sim::Fault>& faults, const Context& context,
                         Clock::time_point started) {
  constexpr logging::Logger log{logging::Component::Cli};
  logging::log_to_file(options.procedure.out / "biopsy.log");
  log.info("dry-run --live: domain {}", options.network.domain);
  report::RunRecord record;
  std::vector<std::string> trouble;
  std::string log_file;
  {
    ProgressLine line;
    line.show(-1.0, "starting the processes");
    LiveOptions network = options.network;
    network.faults = options.faults;
    LiveSession session(network, std::string(drivers::kStageDevices[0]), {}, prepared, options.procedure.out);
    session.wait_until_healthy();
    session.send_plan(std::get<Plan>(prepared.plan));
    std::optional<std::string> ended;
    FaultNotes notes(faults);
    const Robot robot = [&](const OperatorInputs& inputs) -> std::optional<CycleSample> {
      std::optional<CycleSample> sample = session.robot().tick(inputs);
      if (sample) notes.add(sample->record, sample->truth.active_faults);
      if (!ended) ended = session.launcher().ended();
      return sample;
    };
    record = rehearse_on(
        robot, prepared, options.procedure.out,
        [&line](double share, const std::string& what) { line.show(share, what); }, context.interrupted);
    record.real_time = true;
    notes.finish(record);
    if (ended) record.refusal += (record.refusal.empty() ? "" : "; ") + *ended;
    trouble = session.stop();
    log_file = session.settings().log.string();
  }
  for (const std::string& line : trouble) log.error("{}", line);
  record.provenance = provenance_of_faults(options.faults);
  Result result = finished(record, prepared, options.procedure.out, started);
  result.text += fault_lines(record);
  const Seconds scan = prepared.given.rehearsal.scan;
  if (!options.procedure.images_from.empty() || scan >= kRealScan)
    result.text += fmt::format("procedure log: {}\n", log_file);
  else
    result.text += fmt::format(
        "procedure log: {}\nEach image was drawn in {:g} s; a scanner takes 20 to 60 s: `--scan 30` waits as "
        "long.\n",
        log_file, scan.count());
  return result;
}

Result dry_run(const Options& options, const Context& context) {
  const auto started = Clock::now();
  const std::filesystem::path& out = options.procedure.out;
  const std::vector<sim::Fault> faults =
      options.faults.empty() ? std::vector<sim::Fault>{} : sim::read_faults(options.faults);
  if (options.live) refuse_beyond_stage(faults, options.faults);
  ProcedureOptions procedure = options.procedure;
  procedure.real_time = options.live;
  const PreparedCase prepared = prepare_run(case_of(procedure), out, context.clearable);
  if (std::holds_alternative<PlanRefusal>(prepared.plan)) {
    report::RunRecord refused = planned_record(prepared);
    return finished(refused, prepared, out, started);
  }
  return options.live ? through_processes(prepared, options, faults, context, started)
                      : in_lockstep(prepared, out, faults, options.faults, context, started);
}

Result plan(const ProcedureOptions& options, const Context& context) {
  const auto started = Clock::now();
  const PreparedCase prepared = prepare_run(case_of(options), options.out, context.clearable);
  report::RunRecord record = planned_record(prepared);
  if (record.plan) record.outcome = report::Outcome::Completed;  // of what was asked: nothing was to move
  return finished(record, prepared, options.out, started);
}

std::vector<OutputFile> plan_outputs() {
  return {{"report.html", "the report for people"},
          {"report.json", "[the report for programs](#reportjson)"},
          {"plan.mrk.json", "the plan as markups for 3D Slicer"},
          {"plan.rtss.dcm", "the plan as a DICOM RT structure set; only where the planning image is DICOM"},
          {"planning.png", "the planning image along the needle"},
          {"axial.png", "the planning image in three planes through the target, radiological convention"},
          {"coronal.png", "the same"},
          {"sagittal.png", "the same"},
          {"planning", "the planning image of a built-in case, as DICOM"}};
}

}  // namespace dry_run_cli

Command dry_run_command() {
  using namespace dry_run_cli;
  std::vector<OutputFile> outputs = plan_outputs();
  outputs.insert(outputs.end(),
                 {{"run.csv", "[each tick](#runcsv); only where something ran"},
                  {"stage-*.png", "the needle before and after each step of the plan, and the difference"},
                  {"images", "the confirmation image of each step, as DICOM"},
                  {"procedure.log.sqlite", "with `--live`: the [procedure log](procedure-log.md)", true},
                  {"*.log", "with `--live`: the [diagnostic log](diagnostic-log.md) of each process", true}});
  return {
      .name = "dry-run",
      .summary = "rehearse a whole procedure on the simulated stage",
      .description =
          "Plans, drives the simulated stage through every stage of the plan under the supervisor, "
          "takes the confirmation images and checks the depth on them. Nothing real moves.",
      .examples = {"biopsy dry-run gap --seed 2 --out out/gap"},
      .long_examples = {"biopsy dry-run --image scans/t2 --entry 10,-40,20 --target 10,-34,20 --out out/mine",
                        "biopsy dry-run --live gap --out out/live"},
      .exit_codes =
          "0 completed, 3 refused or stopped, 2 for unusable input, 130 where Ctrl-C ended it; the "
          "report of what ran until then is written",
      .outputs = outputs,
      .replaces_earlier_run = true,
      .json = "the content of [report.json](#reportjson)",
      .interruptible = true,
      .declare = with_options(declare_dry_run, dry_run)};
}

Command plan_command() {
  using namespace dry_run_cli;
  return {.name = "plan",
          .summary = "plan a biopsy as dry-run does, without the rehearsal",
          .examples = {"biopsy plan --image out/gap/planning --entry -4.396,33.092,51.854 --target "
                       "-6.737,33.183,50.982 --out out/plan"},
          .exit_codes = "0 planned, 3 refused, 2 for unusable input",
          .outputs = plan_outputs(),
          .replaces_earlier_run = true,
          .json = "the content of [report.json](#reportjson)",
          .declare = with_options(add_procedure_options, plan)};
}

}  // namespace biopsy::robot
