#include "robot/cli/command_line.hpp"

#include <CLI/CLI.hpp>

#include "robot/bench/characterise.hpp"
#include "robot/cli/commands.hpp"
#include "robot/cli/library_messages.hpp"
#include "robot/cli/live_commands.hpp"
#include "robot/cli/log_options.hpp"
#include "robot/cli/study_commands.hpp"

namespace biopsy::robot {
namespace {

void add_dry_run(CLI::App& app, DryRunOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("dry-run", "rehearse a whole procedure on the simulated stage");
  command->footer(
      "Plans, drives the simulated stage through every stage of the plan under the supervisor, takes the "
      "confirmation\n"
      "images, checks the depth on them and writes report.html, report.json and run.csv. Nothing real "
      "moves.\n\n"
      "Example:\n  biopsy dry-run liver --out out/liver\n"
      "  biopsy dry-run --image scans/t2 --entry 10,-40,20 --target 10,-34,20 --out out/mine\n"
      "  biopsy dry-run --live gap --out out/live\n\n"
      "Exit code: 0 completed, 3 refused or stopped, 2 unusable input.");
  procedure_options(*command, options.procedure);
  command->add_flag("--live", options.live,
                    "through the real processes over DDS, in real time, instead of one virtual clock");
  live_options(*command, options.network);
  command->callback([&] {
    code = options.live ? dry_run_live(options.procedure, options.network) : dry_run(options.procedure);
  });
}

void add_plan(CLI::App& app, ProcedureOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("plan", "the same up to the sealed plan; nothing moves, not even in simulation");
  command->footer(
      "Example:\n  biopsy plan gap --out out/plan\n\nExit code: 0 planned, 3 refused, 2 unusable input.");
  procedure_options(*command, options);
  command->callback([&] { code = plan(options); });
}

void add_check(CLI::App& app, CheckOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("check", "depth of the needle from two images, before and after insertion");
  command->footer(
      "Registers the images, looks for what changed along the expected path and says accept, reject or "
      "unsure.\n\n"
      "Example:\n  biopsy check --before scans/plan --after scans/confirm --entry 10,-40,20 --axis 0,1,0 "
      "--expected 6.0\n\n"
      "Exit code: 0 for any verdict, 2 for unusable input.");
  command->add_option("--before", options.before, "image without the needle")->required();
  command->add_option("--after", options.after, "image with the needle")->required();
  command->add_option("--before-series", options.before_series, "series UID, where the folder holds several");
  command->add_option("--after-series", options.after_series, "series UID, where the folder holds several");
  command->add_option("--entry", options.entry, "where depth is zero, R,A,S in mm")->required();
  command->add_option("--axis", options.axis, "insertion direction R,A,S, any length")->required();
  command
      ->add_option("--expected", options.expected_mm,
                   "planned depth in mm: accept only where the tip is there")
      ->check(CLI::Range(0.0, 1000.0));
  command
      ->add_option("--tip-offset", options.tip_offset_mm,
                   "how far the void ends beyond the real tip, mm (default 0)")
      ->check(CLI::Range(-20.0, 20.0));
  command->add_option("--out", options.out, "folder for check.json and two pictures");
  command->add_flag("--json", options.json, "print the result as JSON");
  command->callback([&] { code = check(options); });
}

void add_simulate(CLI::App& app, SimulateOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("simulate", "run the recorded inputs of a data set through a model");
  command->footer(
      "DATASET is a folder with dataset.toml and one CSV a run (docs/reference/model-files.md); the same "
      "comes "
      "out.\n\n"
      "Example:\n  biopsy simulate measured --model sim/models/baseline.toml --out out/simulated");
  command->add_option("DATASET", options.dataset, "folder of the data set")->required();
  command->add_option("--model", options.model, "model file (TOML)")->required();
  command->add_option("--out", options.out, "folder for the simulated data set")->required();
  command->callback([&] { code = simulate(options); });
}

void add_image(CLI::App& app, ImageOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("image", "what an image is: geometry, orientation, warnings");
  command->footer("Example:\n  biopsy image scans/t2 --png out/slices");
  command->add_option("PATH", options.path, "a DICOM folder or file, NIfTI or NRRD")->required();
  command->add_option("--series", options.series, "series UID, where the folder holds several");
  command->add_option("--png", options.png, "folder for an axial, a coronal and a sagittal picture");
  command->callback([&] { code = image(options); });
}

void add_effects(CLI::App& app, EffectsOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("effects", "what a model may contain besides its baseline");
  command->footer(
      "Lists the physical effects of the library; with NAME its equation, parameters and the experiment that "
      "shows it best.\n\n"
      "Example:\n  biopsy effects\n  biopsy effects coulomb_friction\n\n"
      "Exit code: 0, or 2 for a name that is not in the library.");
  command->add_option("NAME", options.name, "one effect (default: all)");
  CLI::Option* json = command->add_flag("--json", options.json, "print as JSON");
  command->add_flag("--markdown", options.markdown, "print as the page docs/reference/effects.md")
      ->excludes(json);
  command->callback([&] { code = effects(options); });
}

void add_gap(CLI::App& app, GapOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("gap", "what a model is missing, from measured runs");
  command->footer(
      "Compares the model with every run of the data set, says where they disagree and which effect or "
      "parameter explains it,\n"
      "and shows on runs it did not use how far that closes the gap. Writes report.html, gap.json and "
      "model.toml, the better model.\n\n"
      "Example:\n  biopsy gap measured --model sim/models/rehearsal.toml --out out/gap\n"
      "  biopsy gap rig --model rig.toml --free m,c_s,k --window 0.5 --out out/rig\n\n"
      "Exit code: 0 for any honest verdict, \"unexplained\" included; 2 for unusable input.");
  command->add_option("DATASET", options.dataset, "folder of the data set (docs/reference/model-files.md)")
      ->required();
  command->add_option("--model", options.model, "model file (TOML)")->required();
  command->add_option("--out", options.out, "folder for the report and the better model")->required();
  command
      ->add_option("--free", options.free,
                   "baseline parameters that are not known, fitted in every hypothesis")
      ->delimiter(',');
  command
      ->add_option("--window", options.window,
                   "simulate in windows of this many seconds, each from a free initial state")
      ->check(CLI::Range(1e-3, 1e6));
  command->add_flag("--accept", options.accept,
                    "replace the model file by the better model; the old one is kept beside it");
  command->add_flag_callback(
      "--no-recheck", [&] { options.recheck = false; }, "leave out the rehearsals with the better model");
  command->callback([&] { code = gap(options); });
}

void add_characterise(CLI::App& app, CharacteriseOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("characterise", "experiments on a stage without patient and needle, for gap");
  command->footer(
      "Plays voltages open loop under the supervisor: dc, staircase, load, impact, frequency. Stores a data "
      "set (one CSV a\nrun) and report.html. A run that the supervisor stops is kept and marked.\n\n"
      "Example:\n  biopsy characterise --dry-run\n  biopsy characterise staircase dc --bench --out "
      "out/stage\n\n"
      "Exit code: 0 completed, 3 stopped, 2 unusable input.");
  command->add_option("EXPERIMENT", options.experiments, "which (default: all)");
  command->add_option("--device", options.device, "the stage: sim or nidaqmx (default sim)");
  command->add_option("--device-config", options.device_config, "channels and scales of the hardware (TOML)");
  command->add_option("--commissioning", options.commissioning,
                      "folder that `biopsy commission` wrote, for a real stage");
  command->add_option("--keys", options.keys,
                      "whose commissioning key signed it; default: the user's own set");
  command->add_option("--model", options.model,
                      "model of the simulated stage (TOML); default: sim/models/rehearsal.toml");
  command->add_option("--weight-g", options.weight_g, "weight on the fixture, g (default 50)");
  command->add_option("--drive-scale", options.drive_scale,
                      "how many times the nominal voltage this stage needs for a depth, 1 to 3 (default 1)");
  command->add_option("--push-scale", options.push_scale,
                      "how many times the nominal push is laid on, 1 to 10 (default 1)");
  command->add_option("--seed", options.seed, "seed of the simulated stage's noise")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--dry-run", options.dry_run, "say what would be done; nothing moves");
  command->add_flag("--bench", options.bench, "I confirm: no patient, no needle");
  command->add_flag("--weights-by-hand", options.weights_by_hand,
                    "real stage: somebody lays weights on with an insulating rod, under voltage, when asked");
  command->add_option("--out", options.out, "folder for the data set");
  command->callback([&] { code = characterise(options); });
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  CLI::App app{"MRI-safe needle biopsy robot: plan, rehearse and verify a needle's depth"};
  app.footer(
      "Start with:\n  biopsy dry-run --out out/first\n\nEach command explains itself: biopsy COMMAND --help");
  app.set_version_flag("--version", BIOPSY_VERSION);
  app.require_subcommand(1);
  app.fallthrough();  // log options stand before or behind the command
  std::string log_level, log_format;
  log_options(app, log_level, log_format);
  std::optional<logging::LogSession> log;
  app.parse_complete_callback([&] {
    log.emplace(log_settings("biopsy", log_level, log_format));
    log_library_messages();
  });
  DryRunOptions rehearsed;
  ProcedureOptions planned;
  CheckOptions checked;
  SimulateOptions simulated;
  ImageOptions shown;
  EffectsOptions listed;
  GapOptions compared;
  CharacteriseOptions measured;
  StudyOptions studied;
  LiveCommandOptions lived;
  int code = 0;
  add_dry_run(app, rehearsed, code);
  add_plan(app, planned, code);
  add_check(app, checked, code);
  add_simulate(app, simulated, code);
  add_image(app, shown, code);
  add_effects(app, listed, code);
  add_gap(app, compared, code);
  add_characterise(app, measured, code);
  add_study_commands(app, studied, code);
  add_live_commands(app, lived, code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int shown_code = app.exit(error);  // prints help or the mistake
    return shown_code == 0 ? 0 : 2;
  }
  return code;
}

}  // namespace biopsy::robot
