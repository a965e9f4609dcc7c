// biopsy characterise: experiments on a stage without patient and needle.
#include "robot/bench/characterise.hpp"

#include <nlohmann/json.hpp>

#include "drivers/needle_stage_factory.hpp"
#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::robot {
namespace characterise_cli {

using Json = nlohmann::ordered_json;

struct Options {
  CharacteriseOptions bench;
  HardwareOptions hardware;
  std::optional<std::uint64_t> seed;
};

void declare(CLI::App& app, Options& options) {
  CharacteriseOptions& bench = options.bench;
  add(app, "EXPERIMENT", bench.experiments, "any of `dc`, `staircase`, `load`, `impact`, `frequency`", "all");
  add_device_options(app, bench.device, options.hardware);
  add(app, "--keys FOLDER", bench.keys, "real stage: the set whose commissioning key signed its record",
      "the user's own");
  add_model(app, bench.model,
            "[model](model-files.md#model) of the simulated stage; of a real stage only its tau counts, for "
            "the rest "
            "between runs, and the default is sim/models/calibrated.toml",
            "sim/models/rehearsal.toml");
  add(app, "--weight-g GRAMS", bench.weight_g,
      "weight on the fixture; on a real stage the one with which the laser's zero was taken", "50")
      ->check(in_range(0, 300, "g"));
  add(app, "--drive-scale S", bench.drive_scale,
      "how many times the nominal voltage this stage needs for a depth", "1")
      ->check(in_range(1, 3));
  add(app, "--push-scale S", bench.push_scale, "how many times the nominal push `load` and `impact` apply",
      "1")
      ->check(in_range(1, 10));
  add_seed(app, options.seed, "the simulated stage's noise");
  app.add_flag("--dry-run", bench.dry_run, "print what would be done; nothing moves");
  app.add_flag("--bench", bench.bench, "confirm: no patient, no needle. Without it nothing moves");
  app.add_flag("--weights-by-hand", bench.weights_by_hand,
               "real stage: a person lays weights on [under "
               "voltage](../how-to/measure-a-stage.md#on-a-real-stage), for "
               "`load` and `impact`");
  add(app, "--until-named MODEL", bench.until_named,
      "one experiment after the other, until what this model lacks [has a "
      "name](../how-to/measure-a-stage.md#until-the-effect-has-a-name) or nothing more can be learnt");
  add_out(app, bench.out, "the data set; required unless `--dry-run`");
}

std::string json_of(const Characterisation& done, const CharacteriseOptions& options) {
  const report::BenchRecord& record = done.record;
  Json runs = Json::array();
  for (const report::BenchRunRecord& run : record.runs)
    runs.push_back(
        {{"name", run.name},
         {"file", run.file},
         {"what", run.what},
         {"weight_g", run.weight_g},
         {"stopped_because", run.stopped_because.empty() ? Json(nullptr) : Json(run.stopped_because)}});
  Json rounds = Json::array();
  for (const NamingRound& round : done.rounds)
    rounds.push_back({{"experiment", round.experiment},
                      {"verdict", round.verdict},
                      {"effect", round.effect.empty() ? Json(nullptr) : Json(round.effect)},
                      {"probability", round.probability},
                      {"gap_closed", round.gap_closed},
                      {"decision", round.decision}});
  const Json all = options.dry_run ? Json{{"dry_run", true}, {"plan", done.text}}
                                   : Json{{"dataset", options.out.string()},
                                          {"device", record.device},
                                          {"complete", done.complete},
                                          {"sensor_noise_mm", record.sensor_noise_mm},
                                          {"runs", runs},
                                          {"rounds", rounds},
                                          {"notes", record.notes}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result run(const Options& given, const Context& context) {
  check_device_options(given.bench.device, given.hardware);
  const bool real = !drivers::is_simulated(given.bench.device);
  if (real && given.seed)
    throw ConfigError("--seed with a real stage, which has its own noise", "command line", "leave it out");
  if (!real && !given.bench.keys.empty())
    throw ConfigError("--keys with the simulated stage, which needs no commissioning", "command line",
                      "leave it out, or add --device nidaqmx");
  CharacteriseOptions options = given.bench;
  options.device_config = given.hardware.config;
  options.commissioning = given.hardware.commissioning;
  options.seed = given.seed.value_or(options.seed);
  const Characterisation done = characterise(options, context.clearable, context.interrupted,
                                             [&](const std::string& line) { context.say(line); });
  return {.exit_code = done.complete ? 0 : 3, .text = done.text, .json = json_of(done, options)};
}

}  // namespace characterise_cli

Command characterise_command() {
  using namespace characterise_cli;
  return {
      .name = "characterise",
      .summary = "experiments on a stage without patient and needle, for gap",
      .description =
          "Plays voltages open loop under the supervisor and stores a [data set]"
          "(model-files.md#data-set): [measuring a stage](../how-to/measure-a-stage.md). A run that the "
          "supervisor "
          "stops is kept and marked.",
      .examples =
          {"biopsy characterise --dry-run", "biopsy characterise impact --bench --out out/impact",
           "biopsy characterise load --bench --until-named docs/examples/no-friction.toml --out out/named"},
      .exit_codes =
          "0 completed, 3 stopped, 2 for unusable input, 130 where Ctrl-C ended it; the needle is "
          "retracted and what was recorded is stored",
      .outputs = {{"dataset.toml",
                   "the runs that were carried out, and the laser's noise at rest. A title "
                   "with \"incomplete\" where one was stopped"},
                  {"run-*.csv",
                   "one run, 1 kHz: the voltage the gate put out, displacement, current (of row "
                   "k: the mean over the row before), push"},
                  {"report.html", "table and pictures"}},
      .replaces_earlier_run = true,
      .json =
          "`dataset`, the folder; `device`, `complete`, `sensor_noise_mm`, `notes`; `runs`: list of "
          "`name`, `file`, `what`, `weight_g`, `stopped_because`; `rounds`, with `--until-named`: "
          "`experiment`, `verdict`, "
          "`effect`, `probability`, `gap_closed`, `decision`. With `--dry-run` `plan`, a text",
      .interruptible = true,
      .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
