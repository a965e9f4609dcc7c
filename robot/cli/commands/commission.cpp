// biopsy commission: takes a stage into service. Real hardware cannot be armed without its record.
#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/commissioning/run_steps.hpp"
#include "drivers/needle_stage_factory.hpp"
#include "robot/bench/commissioning_operator.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/security/key_files.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace commission_cli {

namespace fs = std::filesystem;
using commissioning::Record;

constexpr std::uint64_t kSeed = 1;

struct Options {
  std::string device{drivers::kStageDevices[0]};
  fs::path config;  // channels and scales of the hardware (TOML)
  fs::path key;     // private key that signs the record; empty: the one of `keys init`
  fs::path out;     // folder for record and signature
  bool dry_run = false;
  bool yes = false;  // confirms every step: for rehearsals, simulated stage only
};

void declare(CLI::App& app, Options& options) {
  add_device(app, options.device);
  add(app, "--config FILE", options.config, "channels and scales of the hardware (TOML); for `nidaqmx`");
  add(app, "--key PEM", options.key, "private Ed25519 key that signs the record",
      "the one of `biopsy keys init`");
  add_out(app, options.out, "record and signature; required unless `--dry-run`");
  app.add_flag("--dry-run", options.dry_run, "print the steps with limits and reasons; nothing moves");
  app.add_flag("--yes", options.yes, "confirm every step; simulated stage only");
}

void refuse_unusable(const Options& options) {
  const bool hardware = !drivers::is_simulated(options.device);
  if (hardware && options.config.empty())
    throw ConfigError("the hardware's configuration is missing", "--config",
                      "copy drivers/nidaqmx/usb6211.toml, correct it to your laboratory and give it");
  if (!hardware && !options.config.empty())
    throw ConfigError("a configuration for the simulated stage, which has no hardware", "--config",
                      "leave it out, or add --device nidaqmx");
  if (hardware && options.yes)
    throw ConfigError("a person must confirm each step on real hardware", "--yes", "leave it out");
  if (options.out.empty())
    throw ConfigError("nowhere to put the record", "command line", "add --out FOLDER, or --dry-run");
}

fs::path key_of(const Options& options) {
  if (!options.key.empty()) return options.key;
  return security::signing_files(security::default_folder(), security::Signer::Commissioning).private_key;
}

// Of no file the hash of nothing.
std::string config_hash(const fs::path& file) {
  return hex(sha256(file.empty() ? std::string() : read_file(file, "give --config a file")));
}

Record blank_record(const Options& options) {
  Record record;
  record.config_sha256 = config_hash(options.config);
  record.software = fmt::format("biopsy {}", BIOPSY_VERSION);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  record.made_unix_s = std::chrono::duration_cast<std::chrono::seconds>(now).count();
  return record;
}

Record run_on_simulation(const Options& options, Record record, std::ostream& out) {
  SimulatedBench bench(sim::read_model(data_folder() / "sim/models/rehearsal.toml"), kSeed);
  record.device = {options.device, "simulated stage", 0};
  SupervisedRig rig(bench, bench.connections());
  TerminalOperator terminal(std::cin, out);
  SimulatedOperator operator_(bench, terminal, options.yes);
  return commissioning::run_steps(std::move(record), rig, operator_);
}

Record run_on_hardware(const Options& options, Record record, std::ostream& out) {
  const auto stage = drivers::make_hardware_stage(options.device, options.config);
  record.device = {options.device, stage->product(), stage->serial()};
  const auto supervisor_pulse = drivers::make_supervisor_pulse(options.device, options.config);
  StageConnections connections;
  connections.real_time = true;
  connections.supervisor_pulse = supervisor_pulse.get();
  connections.feed_interlock = [&](bool feeding) { stage->feed_interlock(feeding); };
  if (stage->has_panel())
    connections.estop = [&] {
      return StageConnections::Contacts{stage->panel().estop_a_closed, stage->panel().estop_b_closed};
    };
  TerminalOperator operator_(std::cin, out);
  operator_.notify(fmt::format("{} {}, serial number {}", options.device, stage->product(), stage->serial()));
  operator_.notify(realtime::to_text(realtime::become_realtime({.fifo_priority = kLoopPriority})));
  SupervisedRig rig(*stage, connections);
  record = commissioning::run_steps(std::move(record), rig, operator_);
  if (stage->stopped())
    operator_.notify(fmt::format("  the board stopped: {} {}", stage->last_error().status,
                                 stage->last_error().text.data()));
  return record;
}

// The old signature first: a signature never lies beside a record it does not belong to.
void store(const Record& record, const SigningKey& key, const fs::path& folder) {
  const std::string text = commissioning::to_json(record);
  std::error_code absent;
  fs::remove(folder / commissioning::kSignatureFile, absent);
  atomic_write(folder / commissioning::kRecordFile, text);
  atomic_write(folder / commissioning::kSignatureFile, std::string(view(key.sign(text))));
}

Result run(const Options& options, const Context& context) {
  if (options.dry_run)
    return {.text = commissioning::describe_steps() + "nothing was moved\n",
            .json = nlohmann::ordered_json{{"steps", commissioning::describe_steps()}}.dump(2) + "\n"};
  refuse_unusable(options);
  const Record blank = blank_record(options);
  const SigningKey key(key_of(options));  // an unusable key is refused before the steps
  make_output_folder(options.out, {options.config, options.key},
                     {commissioning::kRecordFile, commissioning::kSignatureFile});
  std::ostream& out = context.json ? std::cerr : std::cout;
  const Record record = drivers::is_simulated(options.device) ? run_on_simulation(options, blank, out)
                                                              : run_on_hardware(options, blank, out);
  store(record, key, options.out);
  return {.exit_code = record.passed() ? 0 : 3,
          .text = fmt::format("\n{}\nrecord: {}\n",
                              record.passed() ? "passed: this stage may be armed for a year"
                                              : "NOT PASSED: this stage must not be armed",
                              (options.out / commissioning::kRecordFile).string()),
          .json = commissioning::to_json(record)};
}

}  // namespace commission_cli

Command commission_command() {
  using namespace commission_cli;
  return {.name = "commission",
          .summary = "first power-up of a stage, step by step",
          .description =
              "Checks wiring, scales, laser, loop rate, interlock and emergency stop, and signs a "
              "record that arming real [hardware](../how-to/commission-a-stage.md) requires.",
          .examples = {"biopsy commission --dry-run"},
          .long_examples = {"biopsy commission --device sim --yes --out out/commissioned"},
          .exit_codes = "0 passed, 3 not passed, 2 for unusable input",
          .outputs = {{"commissioning.json", "the record"}, {"commissioning.sig", "its signature"}},
          .json = "the content of `commissioning.json`; with `--dry-run` `steps`, a text",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
