// biopsy identify: the stack's capacitances and leakage from the amplifier's current.
#include "sim/paper/identification/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/text/number_text.hpp"
#include "robot/report/study/study_html.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace identify_cli {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Options {
  fs::path dataset, model, out;  // model empty: sim/models/baseline.toml
};

void declare(CLI::App& app, Options& options) {
  add(app, "DATASET", options.dataset, "folder of a [data set](model-files.md#data-set) with `current_uA`")
      ->required();
  add_model(app, options.model, "[model](model-files.md#model) that gets the new values",
            "sim/models/baseline.toml");
  add_out(app, options.out, "the result")->required();
}

struct ShownValue {
  const char *name, *unit, *si_unit;
  double si_per_unit;
  sim::CircuitValue value;
  const char* meaning;
};

std::array<ShownValue, 7> shown_values(const sim::IdentifiedCircuit& found) {
  return {{{"C1 K", "nF", "F", 1e-9, found.decay_charge, "charge of the decay a volt"},
           {"C1 (1-K)", "nF", "F", 1e-9, found.jump_charge, "charge of the step a volt"},
           {"tau", "s", "s", 1.0, found.tau, "R (C1+C2)"},
           {"C1", "nF", "F", 1e-9, found.C1, "cable side, eq. (2)"},
           {"C2", "nF", "F", 1e-9, found.C2, "stack"},
           {"R", "GOhm", "Ohm", 1e9, found.R, "leakage"},
           {"K", "", "", 1.0, found.K, "C1/(C1+C2)"}}};
}

std::string json_text(const sim::IdentifiedCircuit& found) {
  Json values = Json::object(), runs = Json::array();
  for (const ShownValue& v : shown_values(found)) {
    Json entry = {{"unit", v.si_unit}, {"known", v.value.known}};
    if (v.value.known) {
      entry["value"] = v.value.value;
      entry["std"] = v.value.std;
      entry["low"] = v.value.low;
      entry["high"] = v.value.high;
    }
    values[v.name] = entry;
  }
  for (const sim::CircuitRun& run : found.runs)
    runs.push_back({{"name", run.name},
                    {"steps", run.steps},
                    {"seconds_after_step", run.after_step},
                    {"offset_uA", 1e6 * run.offset},
                    {"offset_std_uA", 1e6 * run.offset_std}});
  const Json all = {{"values", values},
                    {"noise_uA", 1e6 * found.noise},
                    {"misfit", found.misfit},
                    {"runs", runs},
                    {"warnings", found.warnings}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

// The model with what is known of K, tau and C1.
std::string model_text(sim::NotedModel noted, const sim::IdentifiedCircuit& found,
                       const std::string& source) {
  const auto put = [&](const char* name, double sim::Baseline::*member, const sim::CircuitValue& value) {
    if (!value.known) return;
    noted.model.baseline.*member = value.value;
    noted.notes.values[name] = {std::stod(fmt::format("{:.2e}", value.std)), source};
  };
  put("K", &sim::Baseline::K, found.K);
  put("tau", &sim::Baseline::tau, found.tau);
  put("C1", &sim::Baseline::C1, found.C1);
  return sim::model_toml(noted.model, noted.notes);
}

// As many digits as its width needs to be seen, at least four.
std::string interval_text(double low, double high) {
  const double size = std::max(std::abs(low), std::abs(high)), width = high - low;
  const int digits =
      width > 0.0 ? std::clamp(static_cast<int>(std::ceil(std::log10(size / width))) + 2, 4, 12) : 4;
  return fmt::format("{:.{}g} to {:.{}g}", low, digits, high, digits);
}

std::string text_of(const sim::IdentifiedCircuit& found) {
  std::string text =
      fmt::format("{:<10} {:>10} {:>24}  {:<6} {}\n", "", "value", "95 % interval", "unit", "");
  for (const ShownValue& v : shown_values(found)) {
    const double unit = v.si_per_unit;
    if (v.value.known)
      text += fmt::format("{:<10} {:>10.5g} {:>24}  {:<6} {}\n", v.name, v.value.value / unit,
                          interval_text(v.value.low / unit, v.value.high / unit), v.unit, v.meaning);
    else
      text +=
          fmt::format("{:<10} {:>10} {:>24}  {:<6} {}\n", v.name, "-", "not identifiable", v.unit, v.meaning);
  }
  text += fmt::format("\nmonitor: noise {:.3g} uA a sample, left over {:.2f} times that\n", 1e6 * found.noise,
                      found.misfit);
  for (const sim::CircuitRun& run : found.runs)
    text += fmt::format("  {:<28} {}, {:.1f} s after the first, offset {:.3g} +- {:.1g} uA\n", run.name,
                        counted(run.steps, "step"), run.after_step, 1e6 * run.offset, 1e6 * run.offset_std);
  for (const std::string& warning : found.warnings) text += fmt::format("warning: {}\n", warning);
  return text;
}

report::StudyPage page_of(const sim::IdentifiedCircuit& found, const std::string& title) {
  report::StudyPage page;
  page.title = "R, C1 and C2 from the current";
  page.sentence = found.R.known
                      ? fmt::format("C1 {:.3g} nF, C2 {:.3g} nF, R {:.3g} GOhm.", 1e9 * found.C1.value,
                                    1e9 * found.C2.value, 1e-9 * found.R.value)
                      : fmt::format("Only C1 K, {:.3g} nF, and tau, {:.3g} s, can be identified.",
                                    1e9 * found.decay_charge.value, found.tau.value);
  page.doubted = !found.warnings.empty();
  page.remarks = found.warnings;
  page.remarks.push_back(
      fmt::format("From {}. Noise of the monitor {:.3g} uA a sample; what is left over is {:.2f} times that. "
                  "The pictures leave out "
                  "the steps themselves, whose charge is far above the decay.",
                  title, 1e6 * found.noise, found.misfit));
  report::StudyTable values{"Values", {"", ">Value", ">95 % interval", "Unit", "What"}, {}};
  for (const ShownValue& v : shown_values(found)) {
    const double unit = v.si_per_unit;
    values.rows.push_back(
        {v.name, v.value.known ? fmt::format("{:.4g}", v.value.value / unit) : "–",
         v.value.known ? interval_text(v.value.low / unit, v.value.high / unit) : "not identifiable", v.unit,
         v.meaning});
  }
  report::StudyTable runs{"Runs", {"Run", ">Steps", ">After the first, s", ">Offset of the monitor, uA"}, {}};
  for (const sim::CircuitRun& run : found.runs)
    runs.rows.push_back({run.name, fmt::format("{}", run.steps), fmt::format("{:.1f}", run.after_step),
                         fmt::format("{:.3g} ± {:.1g}", 1e6 * run.offset, 1e6 * run.offset_std)});
  page.tables = {values, runs};
  page.panels = found.panels;
  return page;
}

Result run(const Options& options, const Context& context) {
  const fs::path model = options.model.empty() ? data_folder() / "sim/models/baseline.toml" : options.model;
  const sim::NotedModel noted = sim::read_noted_model(model);
  const sim::Dataset dataset = sim::read_dataset(options.dataset, sim::Drive::Stack);
  const sim::IdentifiedCircuit found = sim::identify_circuit(dataset, options.dataset.string());
  const std::string title = dataset.title.empty() ? options.dataset.filename().string() : dataset.title;
  const std::string new_model = model_text(noted, found, "current in " + title), json = json_text(found);
  claim_run_folder(options.out, {model, options.dataset}, context.clearable);
  atomic_write(options.out / "model.toml", new_model);
  atomic_write(options.out / "identify.json", json);
  atomic_write(options.out / "report.html", report::study_html(page_of(found, title)));
  return {.text = text_of(found) + fmt::format("\nreport: {}\nvalues: {}\nmodel:  {}\n",
                                               (options.out / "report.html").string(),
                                               (options.out / "identify.json").string(),
                                               (options.out / "model.toml").string()),
          .json = json};
}

}  // namespace identify_cli

Command identify_command() {
  using namespace identify_cli;
  return {.name = "identify",
          .summary = "the stack's capacitances and leakage from the amplifier's current",
          .description =
              "Fits C1, C2 and R of the leakage model to the `current_uA` of voltage steps, with 95 % "
              "intervals. Every run holds one voltage after a step; the longer it holds, the better "
              "(three time constants and more).",
          .examples = {"biopsy identify docs/examples/current --out out/identified"},
          .exit_codes = "0, or 2 for a data set without current, without a step, or too short",
          .outputs = {{"report.html", "values and pictures"},
                      {"identify.json",
                       "`values` by name: `unit`, `known`, `value`, `std`, `low`, `high`; "
                       "`noise_uA`, `misfit`, `runs`, `warnings`"},
                      {"model.toml", "the model with the new values"}},
          .replaces_earlier_run = true,
          .json = "the content of `identify.json`",
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
