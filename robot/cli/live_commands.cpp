#include "robot/cli/live_commands.hpp"

namespace biopsy::robot {

void case_options(CLI::App& command, ProcedureOptions& options) {
  command.add_option("CASE", options.case_name,
                     "case file (TOML) or a built-in case: gap, liver (default: liver)");
  command.add_option("--image", options.image, "planning image: a DICOM folder or file, NIfTI or NRRD");
  command.add_option("--series", options.series,
                     "series UID, where the folder holds several (see `biopsy image`)");
  command.add_option("--entry", options.entry, "where the needle tip waits, R,A,S in mm");
  command.add_option("--target", options.target, "where it shall go, R,A,S in mm");
  command.add_option("--labels", options.labels, "label map of the tissues on the same patient");
  command.add_option("--fiducials", options.fiducials,
                     "CSV of fiducial pairs, robot and scanner (docs/reference.md)");
  command.add_option("--model", options.model, "plant model (TOML); default: sim/models/rehearsal.toml");
  command.add_option("--seed", options.seed,
                     "seed of noise and patient motion; the same seed gives the same run");
}

void procedure_options(CLI::App& command, ProcedureOptions& options) {
  case_options(command, options);
  command.add_option("--out", options.out, "folder for the report")->required();
}

void live_options(CLI::App& command, LiveOptions& options) {
  command
      .add_option("--domain", options.domain, "live: DDS domain, one for each robot on a network (default 0)")
      ->check(CLI::Range(0, 230));
  command.add_option(
      "--keys", options.keys,
      "live: folder of `biopsy keys init`; default: the user's own set, in a rehearsal one made for it");
  command.add_flag("--without-security", options.without_security,
                   "live: nobody is authenticated, nothing encrypted; with the simulated stage only");
  command.add_option("--network", options.network, "live: network interface (default: this machine only)");
  command
      .add_option(
          "--fifo", options.fifo_priority,
          "live: SCHED_FIFO priority of the control processes, where permitted (default 60; 0: ordinary)")
      ->check(CLI::Range(0, 90));
}

namespace {

void add_up(CLI::App& app, UpOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("up", "start the live robot's processes and show how they are");
  command->footer(
      "Plans, starts interlock, recorder, supervisor, stage and controller over DDS with security, and shows "
      "their "
      "health\n"
      "until Ctrl-C; then brings them down in order, HV first. Nothing is armed: that takes the key on the "
      "device.\n\n"
      "With --console an image folder is enough: series, entry and target are picked on the page.\n\n"
      "Example:\n  biopsy up gap --seconds 5 --keys out/keys --out out/up\n\n"
      "Exit code: 0, or 3 where a process ended by itself or the plan is refused, 2 for unusable input.");
  procedure_options(*command, options.procedure);
  command->add_option("--device", options.device, "the stage: sim or nidaqmx (default sim)")
      ->check(CLI::IsMember({"sim", "nidaqmx"}));
  command->add_option("--device-config", options.hardware.config,
                      "channels and scales of the hardware (TOML)");
  command->add_option("--commissioning", options.hardware.commissioning,
                      "folder that `biopsy commission` wrote, for a real stage");
  command
      ->add_option("--seconds", options.seconds, "bring it down after this many seconds (default: on Ctrl-C)")
      ->check(CLI::Range(0.0, 1e6));
  command->add_flag("--prepare", options.prepare,
                    "write the run folder and start nothing: for processes that systemd starts");
  command->add_flag("--console", options.console,
                    "the operator's console page: plan, arm and insert in a browser on this machine");
  command->add_flag("--open", options.open, "open that page in the desktop's browser");
  command->add_option("--port", options.port, "of the operator's console page (default: any that is free)");
  live_options(*command, options.live);
  command->callback([&] { code = up(options); });
}

void add_keys(CLI::App& app, KeysOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("keys", "who may say what on the robot's bus: make and check keys");
  command->require_subcommand(1);
  CLI::App* init = command->add_subcommand("init", "make certificates and permissions for every process");
  init->footer("Example:\n  biopsy keys init --keys out/keys\n\nExit code: 0, or 2 where nothing was made.");
  init->add_option("--keys", options.folder, "where (default: the user's own set)");
  init->add_option("--days", options.days, "how long they are good (default 365)")
      ->check(CLI::Range(1, 3650));
  init->add_flag("--replace", options.replace, "move an existing set aside, under its date");
  init->callback([&] { code = keys_init(options); });
  CLI::App* check =
      command->add_subcommand("check", "look through every file: until when, for whom, unchanged");
  check->footer(
      "Example:\n  biopsy keys check --keys out/keys\n\nExit code: 0 all good, 1 something is not, 2 no "
      "such set.");
  check->add_option("--keys", options.folder, "which set (default: the user's own)");
  check->callback([&] { code = keys_check(options); });
}

void add_log(CLI::App& app, LogOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("log", "the procedure log: show, verify, export");
  command->require_subcommand(1);
  const auto add = [&](const char* name, const char* what, const char* footer,
                       int (*run)(const LogOptions&)) {
    CLI::App* verb = command->add_subcommand(name, what);
    verb->footer(footer);
    verb->add_option("LOG", options.log, "the log (SQLite)")->required();
    verb->add_option("--public-key", options.public_key,
                     "key that its head is signed with; default: the one beside it");
    verb->callback([&options, &code, run] { code = run(options); });
    return verb;
  };
  add("show", "print the records", "Example:\n  biopsy log show out/live/procedure.log.sqlite --last 20",
      log_show)
      ->add_option("--last", options.last, "only this many, from the end (default: all)")
      ->check(CLI::Range(0, 1'000'000'000));
  add("verify", "is it whole and unchanged",
      "Example:\n  biopsy log verify out/live/procedure.log.sqlite\n\nExit code: 0 intact, 1 not, 2 unusable "
      "input.",
      log_verify)
      ->add_flag("--json", options.json, "print as JSON");
  add("export", "write it as a table",
      "Example:\n  biopsy log export out/live/procedure.log.sqlite --csv out/log.csv", log_export)
      ->add_option("--csv", options.csv, "the CSV file")
      ->required();
}

void add_commission(CLI::App& app, CommissionOptions& options, int& code) {
  CLI::App* command = app.add_subcommand("commission", "first power-up of a stage, step by step");
  command->footer(
      "Checks wiring, scales, laser, loop rate, interlock and emergency stop, and signs a record that arming "
      "real "
      "hardware requires.\n\n"
      "Example:\n  biopsy commission --dry-run\n  biopsy commission --device sim --yes --out "
      "out/commissioned\n\n"
      "Exit code: 0 passed, 3 not passed, 2 unusable input.");
  command->add_option("--device", options.device, "the stage: sim or nidaqmx (default sim)");
  command->add_option("--config", options.config, "channels and scales of the hardware (TOML)");
  command->add_option("--key", options.key,
                      "private key that signs the record; default: of the user's own set");
  command->add_option("--out", options.out, "folder for commissioning.json and its signature");
  command->add_flag("--dry-run", options.dry_run, "say what would be done; nothing moves");
  command->add_flag("--yes", options.yes, "answer every question with yes: simulated stage only");
  command->callback([&] { code = commission(options); });
}

}  // namespace

void add_live_commands(CLI::App& app, LiveCommandOptions& options, int& code) {
  add_up(app, options.up, code);
  add_keys(app, options.keys, code);
  add_log(app, options.log, code);
  add_commission(app, options.commission, code);
}

}  // namespace biopsy::robot
