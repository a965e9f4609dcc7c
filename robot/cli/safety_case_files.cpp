#include "robot/cli/safety_case_files.hpp"

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::robot {
namespace {

using safety_case::Criterion;
using safety_case::Hazard;
using safety_case::Requirement;
using safety_case::Source;
using safety_case::SourceKind;
using sim::TomlTable;

constexpr double kAnyFigure = 1e12;

Hazard hazard_from(TomlTable table) {
  Hazard hazard;
  hazard.id = table.text("id");
  hazard.name = table.text("name");
  hazard.cause = table.text("cause");
  hazard.harm = table.text("harm");
  hazard.severity = static_cast<int>(table.number("severity", 1, 5));
  hazard.detection = table.text("detection");
  hazard.reaction = table.text("reaction");
  hazard.max_time_ms = static_cast<int>(table.number("max_time_ms", 1, 10'000));
  hazard.requirements = table.texts("requirements");
  hazard.tests = table.texts("tests");
  table.refuse_rest();
  return hazard;
}

Requirement requirement_from(TomlTable table) {
  Requirement requirement{table.text("id"), table.text("text"), table.texts("proofs")};
  table.refuse_rest();
  return requirement;
}

Criterion bar_from(TomlTable table) {
  Criterion bar{table.text("name"), table.text("figure"), table.text("unit"), {}, {}};
  if (table.has("at_least")) bar.at_least = table.number("at_least", -kAnyFigure, kAnyFigure);
  if (table.has("at_most")) bar.at_most = table.number("at_most", -kAnyFigure, kAnyFigure);
  if (!bar.at_least && !bar.at_most)
    throw ConfigError("a bar without a limit", table.where(), "add at_least or at_most");
  table.refuse_rest();
  return bar;
}

SourceKind kind_of(TomlTable& table) {
  if (!table.has("kind")) return SourceKind::Proof;
  const std::string kind = table.text("kind");
  if (kind == "tests") return SourceKind::Tests;
  if (kind == "proof") return SourceKind::Proof;
  throw ConfigError("unknown kind of evidence \"" + kind + "\"", table.place("kind"), "write tests or proof");
}

Source source_from(TomlTable table) {
  Source source;
  source.id = table.text("id");
  source.title = table.text("title");
  source.kind = kind_of(table);
  source.command = table.texts("command");
  if (source.command.empty())
    throw ConfigError("no program to run", table.place("command"), "write command = [\"{tests}/NAME\"]");
  if (table.has("quick")) source.quick = table.texts("quick");
  if (table.has("full")) source.full = table.texts("full");
  if (table.has("in_quick")) source.in_quick = table.flag("in_quick");
  for (TomlTable& bar : table.tables("bars")) source.criteria.push_back(bar_from(bar));
  table.refuse_rest();
  return source;
}

}  // namespace

safety_case::SafetyCase read_safety_case(const std::filesystem::path& folder) {
  safety_case::SafetyCase out;
  TomlTable hazards = sim::read_toml(folder / "hazards.toml");
  for (TomlTable& table : hazards.tables("hazard")) out.hazards.push_back(hazard_from(table));
  hazards.refuse_rest();
  TomlTable requirements = sim::read_toml(folder / "requirements.toml");
  for (TomlTable& table : requirements.tables("requirement"))
    out.requirements.push_back(requirement_from(table));
  requirements.refuse_rest();
  TomlTable evidence = sim::read_toml(folder / "evidence.toml");
  out.claim = evidence.text("claim");
  out.not_covered = evidence.texts("not_covered");
  out.open_items = evidence.texts("open");
  for (TomlTable& table : evidence.tables("evidence")) out.sources.push_back(source_from(table));
  evidence.refuse_rest();
  return out;
}

}  // namespace biopsy::robot
