#include "robot/cli/safety_case/safety_case_files.hpp"

#include "robot/cli/safety_case/risk_files.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::robot {
namespace {

using safety_case::Criterion;
using safety_case::Hazard;
using safety_case::Requirement;
using safety_case::Source;
using safety_case::SourceKind;

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
  if (table.has("max_time_ms")) hazard.max_time_ms = static_cast<int>(table.number("max_time_ms", 1, 10'000));
  hazard.requirements = table.texts("requirements");
  hazard.tests = table.texts("tests");
  return hazard;
}

Requirement requirement_from(TomlTable table) {
  return {table.text("id"), table.text("text"), table.texts("proofs")};
}

Criterion criterion_from(TomlTable table) {
  Criterion criterion{table.text("name"), table.text("figure"), table.text("unit"), {}, {}};
  if (table.has("at_least")) criterion.at_least = table.number("at_least", -kAnyFigure, kAnyFigure);
  if (table.has("at_most")) criterion.at_most = table.number("at_most", -kAnyFigure, kAnyFigure);
  if (!criterion.at_least && !criterion.at_most)
    throw ConfigError("a criterion without a limit", table.where(), "add at_least or at_most");
  return criterion;
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
  if (table.has("side_by_side")) source.side_by_side = table.flag("side_by_side");
  for (TomlTable& criterion : table.tables("bars")) source.criteria.push_back(criterion_from(criterion));
  return source;
}

template <class Row>
std::vector<Row> read_list(const std::filesystem::path& file, const char* name, Row (*row_from)(TomlTable)) {
  return read_toml(file, [&](TomlTable& root) {
    std::vector<Row> rows;
    for (TomlTable& table : root.tables(name)) rows.push_back(row_from(table));
    return rows;
  });
}

}  // namespace

safety_case::SafetyCase read_safety_case(const std::filesystem::path& folder) {
  safety_case::SafetyCase out = read_toml(folder / "evidence.toml", [](TomlTable& evidence) {
    safety_case::SafetyCase read;
    read.claim = evidence.text("claim");
    read.not_covered = evidence.texts("not_covered");
    read.open_items = evidence.texts("open");
    for (TomlTable& table : evidence.tables("evidence")) read.sources.push_back(source_from(table));
    return read;
  });
  out.hazards = read_list(folder / "hazards.toml", "hazard", hazard_from);
  out.requirements = read_list(folder / "requirements.toml", "requirement", requirement_from);
  out.risk = read_risk_file(folder);
  return out;
}

}  // namespace biopsy::robot
