// biopsy reproduce: the paper's experiments on a model.
#include "sim/paper/reproduce.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "robot/cli/command.hpp"
#include "robot/cli/shared_options.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/report/study/reproduction_report.hpp"
#include "sim/paper/held_out.hpp"

namespace biopsy::robot {
namespace reproduce_cli {

namespace fs = std::filesystem;

struct Options {
  std::string figure;  // "6", "7a", "9" for all its parts; empty: all
  fs::path model;      // empty: sim/models/calibrated.toml
  fs::path out;
};

void declare(CLI::App& app, Options& options) {
  add(app, "FIGURE", options.figure, "a figure of the paper: `6`, `7a`, or `9` for all of its parts", "all");
  add_model(app, options.model, "[model](model-files.md#model)", "sim/models/calibrated.toml");
  add_out(app, options.out, "the report")->required();
}

Reproduction reproduced(const sim::paper::PaperModel& model, const std::string& figure,
                        const std::stop_token& stop) {
  ProgressLine line;
  return sim::paper::reproduce(
      model, figure,
      [&line](std::size_t done, std::size_t of, std::string_view number) {
        line.show(static_cast<double>(done) / static_cast<double>(of), fmt::format("figure {}", number));
      },
      stop);
}

// Beside the model: what the leakage model alone meets, and what was measured once of exactly this model.
void compare(Reproduction& result, const std::string& figure, const fs::path& stage,
             const std::stop_token& stop) {
  const fs::path models = data_folder() / "sim/models", films = models / "paper.toml";
  sim::paper::add_leakage_model(
      result, reproduced(sim::paper::read_paper_model(models / "baseline.toml", films), figure, stop));
  const fs::path held_out_file = models / "held_out.toml";
  if (!fs::exists(held_out_file)) return;
  const sim::paper::HeldOut held_out = sim::paper::read_held_out(held_out_file);
  if (held_out.model == sim::paper::digests_of(stage, films)) sim::paper::add_held_out(result, held_out);
}

Result run(const Options& options, const Context& context) {
  sim::paper::figures_named(options.figure);  // refuses before anything is read or touched
  const fs::path stage = options.model.empty() ? data_folder() / "sim/models/calibrated.toml" : options.model;
  const sim::paper::PaperModel model =
      sim::paper::read_paper_model(stage, data_folder() / "sim/models/paper.toml");
  claim_run_folder(options.out, {stage}, context.clearable);
  Reproduction result = reproduced(model, options.figure, context.interrupted);
  compare(result, options.figure, stage, context.interrupted);
  result.model = options.model.empty() ? "sim/models/calibrated.toml" : options.model.string();
  report::save_reproduction(result, options.out);
  std::string text = report::reproduction_console(result, isatty(STDOUT_FILENO) == 1);
  if (!result.left_out.empty())
    text += fmt::format("interrupted: without {}\n", fmt::join(result.left_out, ", "));
  text += fmt::format("\nreport: {}\nrows:   {}\n", (options.out / "report.html").string(),
                      (options.out / "reproduce.json").string());
  return {.text = text, .json = report::reproduction_json(result)};
}

}  // namespace reproduce_cli

Command reproduce_command() {
  using namespace reproduce_cli;
  return {.name = "reproduce",
          .summary = "the paper's experiments on a model, beside its numbers",
          .description =
              "Runs every experiment of the paper, or one. Rows that the model misses are shown with "
              "the reason. How and why: [the paper, beside the model](../explanation/paper.md).",
          .examples = {"biopsy reproduce 2 --out out/figure-2"},
          .long_examples = {"biopsy reproduce --out out/paper"},
          .exit_codes =
              "0 also where rows are missed, 2 for unusable input, 130 where Ctrl-C ended it; the "
              "figures that are ready are written then",
          .outputs = {{"report.html",
                       "plots of the paper's quantities in its units (its ranges are not in the "
                       "text), and a table of paper, ours, band and verdict for each figure"},
                      {"reproduce.json", "[the rows for programs](#reproducejson)"}},
          .replaces_earlier_run = true,
          .json = "the content of [reproduce.json](#reproducejson)",
          .interruptible = true,
          .declare = with_options(declare, run)};
}

}  // namespace biopsy::robot
