// biopsy identify: the stack's capacitances and leakage from the amplifier's current.
#include "sim/paper/identification/identify.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "robot/cli/commands.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/procedure/case.hpp"
#include "robot/report/study/study_html.hpp"
#include "sim/plant/model_text.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

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

void print(const sim::IdentifiedCircuit& found) {
  fmt::print("{:<10} {:>10} {:>24}  {:<6} {}\n", "", "value", "95 % interval", "unit", "");
  for (const ShownValue& v : shown_values(found)) {
    const double unit = v.si_per_unit;
    if (v.value.known)
      fmt::print("{:<10} {:>10.5g} {:>24}  {:<6} {}\n", v.name, v.value.value / unit,
                 fmt::format("{:.5g} to {:.5g}", v.value.low / unit, v.value.high / unit), v.unit, v.meaning);
    else
      fmt::print("{:<10} {:>10} {:>24}  {:<6} {}\n", v.name, "-", "not identifiable", v.unit, v.meaning);
  }
  fmt::print("\nmonitor: noise {:.3g} uA a sample, left over {:.2f} times that\n", 1e6 * found.noise,
             found.misfit);
  for (const sim::CircuitRun& run : found.runs)
    fmt::print("  {:<28} {} step(s), {:.1f} s after the first, offset {:.3g} +- {:.1g} uA\n", run.name,
               run.steps, run.after_step, 1e6 * run.offset, 1e6 * run.offset_std);
  for (const std::string& warning : found.warnings) fmt::print("warning: {}\n", warning);
}

report::StudyPage page_of(const sim::IdentifiedCircuit& found, const std::string& title) {
  report::StudyPage page;
  page.title = "R, C1 and C2 from the current";
  page.sentence = found.R.known
                      ? fmt::format("C1 {:.3g} nF, C2 {:.3g} nF, R {:.3g} GOhm.", 1e9 * found.C1.value,
                                    1e9 * found.C2.value, 1e-9 * found.R.value)
                      : fmt::format("Only C1 K, {:.3g} nF, and tau, {:.3g} s, can be told.",
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
    values.rows.push_back({v.name, v.value.known ? fmt::format("{:.4g}", v.value.value / unit) : "–",
                           v.value.known
                               ? fmt::format("{:.4g} to {:.4g}", v.value.low / unit, v.value.high / unit)
                               : "not identifiable",
                           v.unit, v.meaning});
  }
  report::StudyTable runs{"Runs", {"Run", ">Steps", ">After the first, s", ">Offset of the monitor, uA"}, {}};
  for (const sim::CircuitRun& run : found.runs)
    runs.rows.push_back({run.name, fmt::format("{}", run.steps), fmt::format("{:.1f}", run.after_step),
                         fmt::format("{:.3g} ± {:.1g}", 1e6 * run.offset, 1e6 * run.offset_std)});
  page.tables = {values, runs};
  page.panels = found.panels;
  return page;
}

}  // namespace

int identify(const IdentifyOptions& options) {
  const fs::path model = options.model.empty() ? data_folder() / "sim/models/baseline.toml" : options.model;
  const sim::NotedModel noted = sim::read_noted_model(model);
  const sim::Dataset dataset = sim::read_dataset(options.dataset, sim::Drive::Stack);
  const sim::IdentifiedCircuit found = sim::identify_circuit(dataset, options.dataset.string());
  const std::string title = dataset.title.empty() ? options.dataset.filename().string() : dataset.title;
  const std::string text = model_text(noted, found, "current in " + title);
  claim_run_folder(options.out, {model, options.dataset});
  atomic_write(options.out / "model.toml", text);
  atomic_write(options.out / "identify.json", json_text(found));
  print(found);
  atomic_write(options.out / "report.html", report::study_html(page_of(found, title)));
  fmt::print("\nreport: {}\nvalues: {}\nmodel:  {}\n", (options.out / "report.html").string(),
             (options.out / "identify.json").string(), (options.out / "model.toml").string());
  return 0;
}

}  // namespace biopsy::robot
