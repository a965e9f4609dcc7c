#include "robot/report/safety_case/risk_document.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robot/common/text/number_text.hpp"
#include "robot/common/text/text_layout.hpp"
#include "robot/report/safety_case/risk_checks.hpp"

namespace biopsy::safety_case {
namespace {

std::string hazard_with_name(const SafetyCase& safety_case, const std::string& id) {
  for (const Hazard& hazard : safety_case.hazards)
    if (hazard.id == id) return id + " " + hazard.name;
  return id;
}

std::vector<std::string> level_headings(const std::string& corner) {
  return {corner, "1", "2", "3", "4", "5"};
}

DocumentSection matrix_section(const RiskMatrix& matrix) {
  DocumentSection section{2, "Which risk is acceptable", {}};
  section.sentences = {"acceptable: nothing more is needed",
                       "tolerable: everything practicable was done, and what remains is stated",
                       "not acceptable, open: the control is missing or does not suffice. The robot must not "
                       "be used on a person while "
                       "one of these stands"};
  section.table.headings = level_headings("severity \\ probability");
  for (int severity = kRiskLevels; severity >= 1; --severity) {
    std::vector<std::string> row{std::to_string(severity)};
    for (int probability = 1; probability <= kRiskLevels; ++probability)
      row.push_back(text_of(matrix.at(severity, probability)));
    section.table.rows.push_back(row);
  }
  return section;
}

DocumentSection levels_section(const RiskMatrix& matrix) {
  DocumentSection section{2, "Scales", {}};
  section.table.headings = {"level", "severity of the harm", "probability of the harm, per procedure"};
  for (int level = kRiskLevels; level >= 1; --level) {
    const auto i = static_cast<std::size_t>(level - 1);
    section.table.rows.push_back({std::to_string(level), matrix.severity[i], matrix.probability[i]});
  }
  return section;
}

std::size_t count_at(const RiskFile& file, int severity, int probability) {
  return static_cast<std::size_t>(std::count_if(file.risks.begin(), file.risks.end(), [&](const Risk& risk) {
    return risk.severity == severity && risk.after == probability;
  }));
}

DocumentSection overview_section(const RiskFile& file) {
  DocumentSection section{2, "Risks after control", {}};
  std::vector<std::string> verdicts;
  for (const Acceptability value :
       {Acceptability::NotAcceptable, Acceptability::Tolerable, Acceptability::Acceptable}) {
    const auto n = std::count_if(file.risks.begin(), file.risks.end(),
                                 [&](const Risk& risk) { return risk.residual == value; });
    verdicts.push_back(fmt::format("{} {}", n, text_of(value)));
  }
  section.sentences = {fmt::format("{}: {}", counted(file.risks.size(), "risk"), joined(verdicts, "; ")),
                       "the table counts them by severity and probability"};
  section.table.headings = level_headings("severity \\ probability");
  for (int severity = kRiskLevels; severity >= 1; --severity) {
    std::vector<std::string> row{std::to_string(severity)};
    for (int probability = 1; probability <= kRiskLevels; ++probability) {
      const std::size_t n = count_at(file, severity, probability);
      row.push_back(n == 0 ? "" : std::to_string(n));
    }
    section.table.rows.push_back(row);
  }
  return section;
}

DocumentSection open_section(const SafetyCase& safety_case) {
  DocumentSection section{2, "Not acceptable, open", {}};
  section.table.headings = {"risk", "hazard", "what is missing"};
  for (const Risk* risk : open_risks(safety_case.risk))
    section.table.rows.push_back({risk->id, hazard_with_name(safety_case, risk->hazard), risk->open});
  if (section.table.rows.empty()) section.sentences = {"none"};
  return section;
}

std::string estimate(int severity, int probability, const RiskMatrix& matrix) {
  const std::string verdict = text_of(matrix.at(severity, probability));
  return fmt::format("severity {}, probability {}: {}", severity, probability,
                     verdict.substr(0, verdict.find(',')));
}

// Where the probability comes from: "measured (faults, exploration)".
std::string basis_text(const Risk& risk) {
  return risk.evidence.empty() ? text_of(risk.basis)
                               : fmt::format("{} ({})", text_of(risk.basis), joined(risk.evidence));
}

// "R-06, high voltage above its limit": the first clause of a requirement says what it is about.
std::string requirement_with_clause(const SafetyCase& safety_case, const std::string& id) {
  for (const Requirement& requirement : safety_case.requirements)
    if (requirement.id == id)
      return fmt::format("{} ({})", id, requirement.text.substr(0, requirement.text.find_first_of(":;.")));
  return id;
}

std::string controls_text(const SafetyCase& safety_case, const std::vector<Control>& controls) {
  std::vector<std::string> texts;
  texts.reserve(controls.size());
  for (const Control& control : controls)
    texts.push_back(control.kind + " " + requirement_with_clause(safety_case, control.requirement));
  return texts.empty() ? "none" : joined(texts, "; ");
}

std::string new_risks_text(const SafetyCase& safety_case, const std::vector<std::string>& new_risks) {
  std::vector<std::string> texts;
  texts.reserve(new_risks.size());
  for (const std::string& caused : new_risks) texts.push_back(hazard_with_name(safety_case, caused));
  return texts.empty() ? "none found" : joined(texts, "; ");
}

DocumentSection risk_section(const SafetyCase& safety_case, const Risk& risk) {
  const RiskMatrix& matrix = safety_case.risk.matrix;
  DocumentSection section{3, fmt::format("{}: {}", risk.id, hazard_with_name(safety_case, risk.hazard)), {}};
  section.facts = {
      {"sequence of events", risk.sequence},
      {"hazardous situation", risk.situation},
      {"harm", risk.harm},
      {"before control", estimate(risk.severity, risk.before, matrix) + ". " + risk.before_reason},
      {"controls", controls_text(safety_case, risk.controls)},
      {"after control", estimate(risk.severity, risk.after, matrix) + ". " + risk.after_reason},
      {"basis of the last probability", basis_text(risk)},
      {"new risks", new_risks_text(safety_case, risk.new_risks)}};
  if (!risk.open.empty()) section.facts.emplace_back("missing", risk.open);
  return section;
}

std::string tests_text(const std::vector<std::string>& tests) {
  return tests.empty() ? "none" : joined(tests, "; ");
}

DocumentSection items_section(const RiskFile& file) {
  DocumentSection section{2, "Software items and safety class", {}};
  section.sentences = {
      "class C: a failure can lead to death or serious injury; B: to an injury that is not serious; A: to "
      "none",
      "the class is that of the item without hardware outside the software; separation lowers none here"};
  section.table.headings = {"item", "name", "class", "folders", "why this class", "separation"};
  for (const SoftwareItem& item : file.items)
    section.table.rows.push_back(
        {item.id, item.name, item.safety_class, joined(item.folders), item.reason, item.separation});
  return section;
}

DocumentSection soup_section(const RiskFile& file) {
  DocumentSection section{2, "SOUP", file.soup_limits};
  section.table.headings = {"name", "version",           "package",
                            "for",  "its failure could", "known anomalies that matter here"};
  for (const Soup& soup : file.soup)
    section.table.rows.push_back(
        {soup.name, soup.version, soup.package, soup.purpose, soup.failure,
         soup.anomalies.empty() ? "none known to us" : joined(soup.anomalies, "; ")});
  return section;
}

DocumentSection threats_section(const SafetyCase& safety_case) {
  DocumentSection section{2, "Threats", {}};
  section.table.headings = {"threat", "way", "hazard", "countermeasure", "tests", "what remains"};
  for (const Threat& threat : safety_case.risk.threats)
    section.table.rows.push_back({threat.id + " " + threat.threat, threat.way, threat.hazard,
                                  threat.countermeasure, tests_text(threat.tests),
                                  (threat.open ? "OPEN: " : "") + threat.residual});
  return section;
}

DocumentSection scenarios_section(const SafetyCase& safety_case) {
  DocumentSection section{2, "Hazard-related use scenarios", safety_case.risk.scenario_limits};
  section.table.headings = {"scenario", "task",        "use error", "hazard", "what the design does",
                            "tests",    "what remains"};
  for (const UseScenario& scenario : safety_case.risk.scenarios)
    section.table.rows.push_back({scenario.id + " " + scenario.user, scenario.task, scenario.use_error,
                                  scenario.hazard, scenario.design, tests_text(scenario.tests),
                                  (scenario.open ? "OPEN: " : "") + scenario.residual});
  return section;
}

}  // namespace

std::vector<DocumentSection> risk_document(const SafetyCase& safety_case) {
  const RiskFile& file = safety_case.risk;
  std::vector<DocumentSection> sections{
      open_section(safety_case),   overview_section(file),      {2, "How risks are estimated", file.rules},
      levels_section(file.matrix), matrix_section(file.matrix), {2, "Risks", {}}};
  for (const Risk& risk : file.risks) sections.push_back(risk_section(safety_case, risk));
  sections.push_back(items_section(file));
  sections.push_back(soup_section(file));
  sections.push_back(threats_section(safety_case));
  sections.push_back(scenarios_section(safety_case));
  return sections;
}

}  // namespace biopsy::safety_case
