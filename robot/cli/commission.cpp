// biopsy commission: takes a stage into service. Nothing arms on hardware without the record of it.
#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/commissioning/signature.hpp"
#include "drivers/commissioning/walk.hpp"
#include "drivers/nidaqmx/nidaqmx_stage.hpp"
#include "drivers/nidaqmx/pulse_line.hpp"
#include "robot/bench/commissioning_operator.hpp"
#include "robot/cli/live_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/encoding.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/sha256.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "robot/procedure/case.hpp"
#include "robot/security/key_files.hpp"
#include "sim/plant/model_file.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;
using commissioning::Record;

constexpr std::uint64_t kSeed = 1;

void refuse_unusable(const CommissionOptions& options) {
  const bool hardware = options.device == "nidaqmx";
  if (!hardware && options.device != "sim")
    throw ConfigError(fmt::format("there is no device \"{}\"", options.device), "--device",
                      "use sim or nidaqmx");
  if (hardware && options.config.empty())
    throw ConfigError("the hardware's configuration is missing", "--config",
                      "copy drivers/nidaqmx/usb6211.toml, correct it to your laboratory and give it");
  if (hardware && options.yes)
    throw ConfigError("nobody else can answer for what hands do at real hardware", "--yes", "leave it out");
  if (options.out.empty())
    throw ConfigError("nowhere to put the record", "command line", "add --out FOLDER, or --dry-run");
}

fs::path key_of(const CommissionOptions& options) {
  if (!options.key.empty()) return options.key;
  return security::signing_files(security::default_folder(), security::Signer::Commissioning).private_key;
}

// Of no file the hash of nothing.
std::string config_hash(const fs::path& file) {
  return hex(sha256(file.empty() ? std::string() : read_file(file, "give --config a file")));
}

Record blank_record(const CommissionOptions& options) {
  Record record;
  record.config_sha256 = config_hash(options.config);
  record.software = fmt::format("biopsy {}", BIOPSY_VERSION);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  record.made_unix_s = std::chrono::duration_cast<std::chrono::seconds>(now).count();
  return record;
}

Record walked_on_simulation(const CommissionOptions& options, Record record) {
  SimulatedBench bench(sim::read_model(blank_case().rehearsal.model), kSeed);
  record.device = {"sim", "simulated stage", 0};
  SupervisedRig rig(bench, bench.trimmings());
  TerminalOperator terminal(std::cin, std::cout);
  SimulatedOperator operator_(bench, terminal, options.yes);
  return commissioning::run_steps(std::move(record), rig, operator_);
}

Record walked_on_hardware(const CommissionOptions& options, Record record) {
  const nidaqmx::Config config = nidaqmx::read_config(options.config);
  nidaqmx::NidaqmxStage stage(config);
  record.device = {"nidaqmx", stage.product(), stage.serial()};
  nidaqmx::PulseLine supervisors_half(config);
  StageTrimmings trimmings;
  trimmings.real_time = true;
  trimmings.supervisor_pulse = &supervisors_half;
  trimmings.feed_interlock = [&](bool feeding) { stage.feed_interlock(feeding); };
  if (stage.has_panel())
    trimmings.estop = [&] {
      return StageTrimmings::Contacts{stage.panel().estop_a_closed, stage.panel().estop_b_closed};
    };
  TerminalOperator operator_(std::cin, std::cout);
  operator_.notify(fmt::format("{} {}, serial number {}", config.device, stage.product(), stage.serial()));
  operator_.notify(realtime::to_text(realtime::become_realtime({.fifo_priority = kLoopPriority})));
  SupervisedRig rig(stage, trimmings);
  record = commissioning::run_steps(std::move(record), rig, operator_);
  if (stage.stopped())
    operator_.notify(
        fmt::format("  the board stopped: {} {}", stage.trouble().status, stage.trouble().text.data()));
  return record;
}

// The old signature first: at no moment does one lie beside a record it does not belong to.
void store(const Record& record, const commissioning::SigningKey& key, const fs::path& folder) {
  const std::string text = commissioning::to_json(record);
  std::error_code absent;
  fs::remove(folder / commissioning::kSignatureFile, absent);
  atomic_write(folder / commissioning::kRecordFile, text);
  atomic_write(folder / commissioning::kSignatureFile, key.sign(text));
}

}  // namespace

int commission(const CommissionOptions& options) {
  if (options.dry_run) {
    fmt::print("{}nothing was moved\n", commissioning::description());
    return 0;
  }
  refuse_unusable(options);
  const Record blank = blank_record(options);
  const commissioning::SigningKey key(key_of(options));  // before anybody has worked for nothing
  const Record record =
      options.device == "sim" ? walked_on_simulation(options, blank) : walked_on_hardware(options, blank);
  store(record, key, options.out);
  fmt::print("\n{}\nrecord: {}\n",
             record.passed() ? "passed: this stage may be armed for a year"
                             : "NOT PASSED: this stage must not be armed",
             (options.out / commissioning::kRecordFile).string());
  return record.passed() ? 0 : 3;
}

}  // namespace biopsy::robot
