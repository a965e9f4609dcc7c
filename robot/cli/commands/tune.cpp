// biopsy tune: K_p and K_i for a model, with margin.
#include "sim/paper/tuning/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/cli/tuning_report.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/case/controller_file.hpp"

namespace biopsy::robot {
namespace tune_cli {

namespace fs = std::filesystem;

struct Options {
  fs::path model, out;  // model empty: sim/models/calibrated.toml; out empty: no files
  int stages = 24;      // that the model's uncertainty leaves room for
  std::uint64_t seed = 1;
};

void declare(CLI::App& app, Options& options) {
  add_model(app, options.model, "[model](model-files.md#model)", "sim/models/calibrated.toml");
  add(app, "--stages N", options.stages, "stages drawn from the model's uncertainty", "24")
      ->check(in_range(0, 200));
  add_seed(app, options.seed, "that draw");
  add_out(app, options.out, "the report")->default_str("no files");
}

// As wide as people see it: a degree sign is two bytes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string text_of(const report::StudyTable& table) {
  std::vector<std::vector<std::string>> lines{{}};
  for (const std::string& column : table.columns)
    lines[0].push_back(column.substr(column.starts_with('>') ? 1 : 0));
  lines.insert(lines.end(), table.rows.begin(), table.rows.end());
  std::string out = fmt::format("\n{}\n", table.heading);
  for (const std::vector<std::string>& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      std::size_t most = 0;
      for (const std::vector<std::string>& other : lines) most = std::max(most, width(other[i]));
      const std::string gap(most - width(line[i]), ' ');
      text += "  " + (table.columns[i].starts_with('>') ? gap + line[i] : line[i] + gap);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  }
  return out;
}

void write_controllers(const sim::tuning::Tuning& found, const fs::path& out, const std::string& model) {
  const auto write = [&](const sim::tuning::EvaluatedGains& one, const char* file) {
    atomic_write(out / file,
                 controller_toml(one.gains, fmt::format("{} of biopsy tune for {}", one.name, model)));
  };
  write(found.evaluated.at(1), "controller.toml");
  if (found.improved) write(*found.improved, "improved.toml");
}

Result run(const Options& options, const Context& context) {
  const fs::path file = options.model.empty() ? data_folder() / "sim/models/calibrated.toml" : options.model;
  const std::string name = options.model.empty() ? "sim/models/calibrated.toml" : options.model.string();
  const sim::NotedModel model = sim::read_noted_model(file);
  if (!options.out.empty()) claim_run_folder(options.out, {file}, context.clearable);
  const auto started = std::chrono::steady_clock::now();
  sim::tuning::Tuning found;
  {
    ProgressLine line;
    found = sim::tuning::tune(model,
                              {.stages = options.stages,
                               .seed = options.seed,
                               .wanted = {},
                               .grid = 13,
                               .stop = context.interrupted},
                              [&line](double share, const std::string& what) { line.show(share, what); });
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const report::StudyPage page = tuning_page(found, name);
  const std::string json = tuning_json(found, name, seconds);
  std::string text = fmt::format("{}\n{}\n", page.sentence, page.remarks.front());
  for (const report::StudyTable& table : page.tables) text += text_of(table);
  if (options.out.empty()) return {.text = text, .json = json};
  atomic_write(options.out / "report.html", report::study_html(page));
  atomic_write(options.out / "tune.json", json);
  write_controllers(found, options.out, name);
  text += fmt::format("\ncontroller: {}", (options.out / "controller.toml").string());
  text += fmt::format("\nreport:  {}\nnumbers: {}\n", (options.out / "report.html").string(),
                      (options.out / "tune.json").string());
  return {.text = text, .json = json};
}

}  // namespace tune_cli

Command tune_command() {
  using namespace tune_cli;
  return {.name = "tune",
          .summary = "gains of the PI loop for a model, with gain and phase margin",
          .description =
              "Finds K_p and K_i that keep 6 dB and 45 degrees at every depth and on every stage that "
              "the model's uncertainty leaves room for, and have the least cost in time; shows what "
              "the paper's 0.8 and 0.005 reach, and what feed-forward would add; looks for gains that "
              "improve on the paper's. Changes "
              "nothing: `--controller` of dry-run and of the live robot takes the file it writes.",
          .long_examples = {"biopsy tune --out out/gains"},
          .exit_codes =
              "0 also where no gains have the margin, 2 for unusable input, 130 where Ctrl-C ended the "
              "search; the best gains until then are written",
          .outputs = {{"controller.toml", "the tuned gains, for `--controller`"},
                      {"improved.toml", "gains that improve on the paper's, where there are", true},
                      {"report.html", "gains, margins and courses in time"},
                      {"tune.json",
                       "`met`, `wanted`, `uncertain`, `stages`, `refused`, and `controllers`: gains, "
                       "`margins` at each depth, `worst_margins`, `score`, `worst_score`; "
                       "`improved`: gains better than the paper's in one respect and worse in none, or null; "
                       "`interrupted` where it was"}},
          .replaces_earlier_run = true,
          .json = "the content of `tune.json`",
          .interruptible = true,
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
