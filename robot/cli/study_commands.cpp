#include "robot/cli/study_commands.hpp"

namespace biopsy::robot {
namespace {

void add_reproduce(CLI::App& app, ReproduceOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("reproduce", "the paper's experiments on a model, beside its numbers");
  command->footer(
      "Runs every experiment of the paper, or one, and writes report.html (our plots, and a table paper, "
      "ours, "
      "band, verdict\n"
      "for each figure) and reproduce.json. Rows that the model misses are shown with the reason.\n\n"
      "Example:\n  biopsy reproduce --out out/paper\n  biopsy reproduce 9a --out out/figure-9a\n\n"
      "Exit code: 0 also where rows are missed, 2 for unusable input.");
  command->add_option("FIGURE", options.figure,
                      "a figure of the paper: 6, 7a, or 9 for all of its parts (default: all)");
  command->add_option("--model", options.model, "model file (TOML); default: sim/models/calibrated.toml");
  command->add_option("--out", options.out, "folder for the report")->required();
  command->callback([&] { code = reproduce(options); });
}

void add_calibrate(CLI::App& app, CalibrateOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("calibrate", "one parameter set for all of the paper's figures");
  command->footer(
      "Searches the numbers of the stage, within what is plausible, for the set that reaches most of the "
      "paper's rows,\n"
      "and writes calibrated.toml (with standard deviations, correlations, sources), paper.toml (other "
      "films, "
      "joint)\nand calibration.json.\n"
      "Measured runs given by --data count beside the paper's. Nothing in sim/models is touched: copy both "
      "files there to adopt them.\n\n"
      "Example:\n  biopsy calibrate --out out/calibrated\n"
      "  biopsy calibrate --data measured --out out/calibrated\n\n"
      "Exit code: 0, or 2 for unusable input. The same seed and number of evaluations give the same answer.");
  command->add_option("--model", options.model,
                      "what no search turns, such as the sensor; default: sim/models/calibrated.toml");
  command->add_option("--data", options.data,
                      "folder of a data set (docs/reference/model-files.md); may be repeated");
  command
      ->add_option("--evaluations", options.evaluations,
                   "budget of a global search (default 600; --from-nominal has two searches, of 1600 each)")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--seed", options.seed, "seed of the search")->check(CLI::NonNegativeNumber);
  command->add_flag("--from-nominal", options.from_nominal,
                    "begin at what was known beforehand, not at what earlier searches found");
  command->add_option("--out", options.out, "folder for the result")->required();
  command->callback([&] { code = calibrate(options); });
}

void add_identify(CLI::App& app, IdentifyOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("identify", "the stack's capacitances and leakage from the amplifier's current");
  command->footer(
      "Fits C1, C2 and R of the leakage model to the current_uA of voltage steps, with 95 % intervals, and "
      "writes "
      "identify.json\n"
      "and model.toml. Every run holds one voltage after a step; the longer it holds, the better (three time "
      "constants and more).\n\n"
      "Example:\n  biopsy identify docs/examples/current --out out/identified\n\n"
      "Exit code: 0, or 2 for a data set without current, without a step, or too short.");
  command->add_option("DATASET", options.dataset, "folder of the data set (docs/reference/model-files.md)")
      ->required();
  command->add_option("--model", options.model,
                      "model file (TOML) that gets the new values; default: sim/models/baseline.toml");
  command->add_option("--out", options.out, "folder for the result")->required();
  command->callback([&] { code = identify(options); });
}

void add_design(CLI::App& app, DesignOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("design", "which stacks are better than the paper's, and at what price");
  command->footer(
      "Varies oil volume, electrodes, film thickness, number of pouches and spring, and keeps the designs of "
      "which none beats\n"
      "another in everything: stroke, ripple, bandwidth, peak field, stack height. Writes report.html and "
      "design.json.\n\n"
      "Example:\n  biopsy design --out out/design\n\nExit code: 0, or 2 for unusable input.");
  command->add_option("--model", options.model, "model file (TOML); default: sim/models/calibrated.toml");
  command->add_option("--seed", options.seed, "seed of the search; the same seed gives the same designs")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", options.out, "folder for the report")->required();
  command->callback([&] { code = design(options); });
}

void add_tune(CLI::App& app, TuneOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("tune", "gains of the PI loop for a model, with margin");
  command->footer(
      "Finds K_p and K_i that keep 6 dB and 45 degrees at every depth and on every stage the model's "
      "uncertainty leaves room for,\nand are best in time; says what the paper's 0.8 and 0.005 reach, and "
      "what "
      "feed-forward would add.\nWrites report.html and tune.json. Changes nothing: gains are the operator's "
      "to "
      "set.\n\n"
      "Example:\n  biopsy tune --out out/gains\n\n"
      "Exit code: 0 also where no gains have the margin, 2 for unusable input.");
  command->add_option("--model", options.model, "model file (TOML); default: sim/models/calibrated.toml");
  command->add_option("--stages", options.stages, "stages drawn from the model's uncertainty (default 24)")
      ->check(CLI::Range(0, 200));
  command->add_option("--seed", options.seed, "seed of that draw; the same seed gives the same gains")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", options.out, "folder for the report (default: no files)");
  command->callback([&] { code = tune(options); });
}

void add_safety_case(CLI::App& app, SafetyCaseOptions& options, int& code) {
  CLI::App* command =
      app.add_subcommand("safety-case", "hazards, requirements, argument and evidence of this build");
  command->footer(
      "Runs every test and proof that the case names (about a quarter of an hour) and writes report.html, "
      "argument.svg and safety-case.json.\nFails on a requirement without fresh evidence, a test that names "
      "an unknown "
      "requirement, a broken link, a figure outside its bar.\n./dev safety-case builds what it needs and "
      "runs it.\n\n"
      "Example:\n  biopsy safety-case --out out/safety-case\n"
      "  biopsy safety-case --collect out/safety-case/evidence --out out/again\n\n"
      "Exit code: 0 no gap, 3 the case does not hold, 2 for unusable input.");
  command->add_flag("--quick", options.quick, "the short subset, two minutes; releases nothing");
  command->add_option("--collect", options.collect, "evidence folder of an earlier case; nothing is run");
  command->add_option("--out", options.out, "folder for the case")->required();
  command->callback([&] { code = safety_case(options); });
}

}  // namespace

void add_study_commands(CLI::App& app, StudyOptions& options, int& code) {
  add_reproduce(app, options.reproduced, code);
  add_calibrate(app, options.calibrated, code);
  add_identify(app, options.identified, code);
  add_design(app, options.designed, code);
  add_tune(app, options.tuned, code);
  add_safety_case(app, options.safety, code);
}

}  // namespace biopsy::robot
