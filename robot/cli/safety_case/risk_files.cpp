#include "robot/cli/safety_case/risk_files.hpp"

#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::robot {
namespace {

using safety_case::Acceptability;
using safety_case::Basis;
using safety_case::Control;
using safety_case::kRiskLevels;
using safety_case::Risk;
using safety_case::RiskFile;
using safety_case::RiskMatrix;
using safety_case::SoftwareItem;
using safety_case::Soup;
using safety_case::Threat;
using safety_case::UseScenario;

int level(TomlTable& table, const char* name) {
  const double value = table.number(name, 1, kRiskLevels);
  if (value != std::floor(value)) table.refuse(name, "is no whole number", "write 1, 2, 3, 4 or 5");
  return static_cast<int>(value);
}

std::string text_or_none(TomlTable& table, const char* name) {
  return table.has(name) ? table.text(name) : std::string();
}

std::vector<std::string> texts_or_none(TomlTable& table, const char* name) {
  return table.has(name) ? table.texts(name) : std::vector<std::string>();
}

std::string one_of(TomlTable& table, const char* name, const std::vector<std::string>& words) {
  const std::string word = table.text(name);
  std::string all;
  for (const std::string& known : words) {
    if (known == word) return word;
    all += (all.empty() ? "" : ", ") + known;
  }
  table.refuse(name, "is \"" + word + "\"", "write one of: " + all);
}

Acceptability acceptability(TomlTable& table, const char* name, const std::string& text) {
  if (const auto value = safety_case::acceptability_from(text)) return *value;
  table.refuse(name, "holds \"" + text + "\"", "write acceptable, tolerable or not acceptable, open");
}

std::array<std::string, kRiskLevels> five_texts(TomlTable& table, const char* name) {
  const std::vector<std::string> texts = table.texts(name);
  if (texts.size() != kRiskLevels)
    table.refuse(name, "has not one entry for each level", "write five, level 1 first");
  std::array<std::string, kRiskLevels> five;
  std::copy(texts.begin(), texts.end(), five.begin());
  return five;
}

// A worse risk is never judged more kindly.
void check_monotonic(const RiskMatrix& matrix, TomlTable& table) {
  for (int severity = 1; severity <= kRiskLevels; ++severity)
    for (int probability = 1; probability <= kRiskLevels; ++probability)
      if ((severity > 1 && matrix.at(severity, probability) < matrix.at(severity - 1, probability)) ||
          (probability > 1 && matrix.at(severity, probability) < matrix.at(severity, probability - 1)))
        table.refuse("severity_" + std::to_string(severity),
                     "judges a worse risk more kindly than a lesser one",
                     "let no entry be better than the one above it or before it");
}

RiskMatrix matrix_from(TomlTable table) {
  RiskMatrix matrix;
  matrix.severity = five_texts(table, "severity");
  matrix.probability = five_texts(table, "probability");
  for (std::size_t row = 0; row < kRiskLevels; ++row) {
    const std::string name = "severity_" + std::to_string(row + 1);
    const std::array<std::string, kRiskLevels> words = five_texts(table, name.c_str());
    for (std::size_t column = 0; column < kRiskLevels; ++column)
      matrix.verdicts[row][column] = acceptability(table, name.c_str(), words[column]);
  }
  check_monotonic(matrix, table);
  return matrix;
}

Basis basis_from(TomlTable& table) {
  const std::string word = one_of(table, "basis", {"measured", "estimated", "unknown"});
  return word == "measured" ? Basis::Measured : word == "estimated" ? Basis::Estimated : Basis::Unknown;
}

Risk risk_from(TomlTable table) {
  Risk risk;
  risk.id = table.text("id");
  risk.hazard = table.text("hazard");
  risk.sequence = table.text("sequence");
  risk.situation = table.text("situation");
  risk.harm = table.text("harm");
  risk.severity = level(table, "severity");
  risk.before = level(table, "before");
  risk.before_reason = table.text("before_reason");
  risk.after = level(table, "after");
  risk.after_reason = table.text("after_reason");
  risk.basis = basis_from(table);
  risk.evidence = texts_or_none(table, "evidence");
  for (TomlTable& control : table.tables("controls"))
    risk.controls.push_back(
        {one_of(control, "kind", {"inherent", "protective", "information"}), control.text("requirement")});
  risk.residual = acceptability(table, "residual", table.text("residual"));
  risk.open = text_or_none(table, "open");
  risk.new_risks = texts_or_none(table, "new_risks");
  return risk;
}

SoftwareItem item_from(TomlTable table) {
  return {table.text("id"),       table.text("name"),
          table.texts("folders"), one_of(table, "safety_class", {"A", "B", "C"}),
          table.text("reason"),   table.text("separation")};
}

Soup soup_from(TomlTable table) {
  return {table.text("name"),
          table.text("package"),
          table.text("version"),
          table.has("manager") ? one_of(table, "manager", {"dpkg", "npm"}) : "dpkg",
          texts_or_none(table, "libraries"),
          table.text("purpose"),
          table.text("failure"),
          texts_or_none(table, "anomalies")};
}

Threat threat_from(TomlTable table) {
  return {table.text("id"),
          table.text("threat"),
          table.text("way"),
          table.text("hazard"),
          table.text("countermeasure"),
          texts_or_none(table, "tests"),
          table.text("residual"),
          table.has("open") && table.flag("open")};
}

UseScenario scenario_from(TomlTable table) {
  return {table.text("id"),
          table.text("user"),
          table.text("task"),
          table.text("use_error"),
          table.text("hazard"),
          table.text("design"),
          texts_or_none(table, "tests"),
          table.text("residual"),
          table.has("open") && table.flag("open")};
}

template <class Row>
void read_rows(TomlTable& root, const char* name, Row (*row_from)(TomlTable), std::vector<Row>& rows) {
  for (TomlTable& table : root.tables(name)) rows.push_back(row_from(table));
}

}  // namespace

RiskFile read_risk_file(const std::filesystem::path& folder) {
  RiskFile file = read_toml(folder / "risk.toml", [](TomlTable& root) {
    RiskFile read;
    read.scope = root.text("scope");
    read.rules = root.texts("rules");
    read.matrix = matrix_from(root.table("matrix"));
    read_rows(root, "risk", risk_from, read.risks);
    return read;
  });
  read_toml(folder / "software.toml", [&](TomlTable& root) {
    file.soup_limits = root.texts("limits");
    read_rows(root, "item", item_from, file.items);
    read_rows(root, "soup", soup_from, file.soup);
    return 0;
  });
  read_toml(folder / "threats.toml", [&](TomlTable& root) {
    read_rows(root, "threat", threat_from, file.threats);
    return 0;
  });
  read_toml(folder / "scenarios.toml", [&](TomlTable& root) {
    file.scenario_limits = root.texts("limits");
    read_rows(root, "scenario", scenario_from, file.scenarios);
    return 0;
  });
  return file;
}

}  // namespace biopsy::robot
