// biopsy tune: K_p and K_i for a model, with margin.
#include "sim/paper/tuning/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "robot/cli/commands.hpp"
#include "robot/cli/tuning_text.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/output_folder.hpp"
#include "robot/common/progress.hpp"
#include "robot/procedure/case.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

// As wide as people see it: a degree sign is two bytes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

void print(const report::StudyTable& table) {
  std::vector<std::vector<std::string>> lines{{}};
  for (const std::string& column : table.columns)
    lines[0].push_back(column.substr(column.starts_with('>') ? 1 : 0));
  lines.insert(lines.end(), table.rows.begin(), table.rows.end());
  fmt::print("\n{}\n", table.heading);
  for (const std::vector<std::string>& line : lines) {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      std::size_t most = 0;
      for (const std::vector<std::string>& other : lines) most = std::max(most, width(other[i]));
      const std::string gap(most - width(line[i]), ' ');
      text += "  " + (table.columns[i].starts_with('>') ? gap + line[i] : line[i] + gap);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    fmt::print("{}\n", text);
  }
}

}  // namespace

int tune(const TuneOptions& options) {
  const fs::path file = options.model.empty() ? data_folder() / "sim/models/calibrated.toml" : options.model;
  const std::string name = options.model.empty() ? "sim/models/calibrated.toml" : options.model.string();
  const sim::NotedModel model = sim::read_noted_model(file);
  if (!options.out.empty()) claim_run_folder(options.out, {file});
  const auto started = std::chrono::steady_clock::now();
  sim::tuning::Tuning found;
  {
    ProgressLine line;
    found =
        sim::tuning::tune(model, {.stages = options.stages, .seed = options.seed, .wanted = {}, .grid = 13},
                          [&line](double share, const std::string& what) { line.show(share, what); });
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  const report::StudyPage page = tuning_page(found, name);
  fmt::print("{}\n", page.sentence);
  for (const report::StudyTable& table : page.tables) print(table);
  if (options.out.empty()) return 0;
  atomic_write(options.out / "report.html", report::study_html(page));
  atomic_write(options.out / "tune.json", tuning_json(found, name, seconds));
  fmt::print("\nreport:  {}\nnumbers: {}\n", (options.out / "report.html").string(),
             (options.out / "tune.json").string());
  return 0;
}

}  // namespace biopsy::robot
