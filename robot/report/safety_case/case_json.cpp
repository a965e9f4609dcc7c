#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "robot/common/text/text_layout.hpp"
#include "robot/report/safety_case/case_page.hpp"
#include "robot/report/safety_case/gaps.hpp"
#include "robot/report/safety_case/risk_checks.hpp"

namespace biopsy::safety_case {
namespace {

using nlohmann::json;

json criterion_json(const Source& source, const Criterion& criterion, const Finding* finding) {
  json out{{"name", criterion.name},
           {"evidence", source.id},
           {"figure", criterion.figure},
           {"unit", criterion.unit}};
  if (criterion.at_least) out["at_least"] = *criterion.at_least;
  if (criterion.at_most) out["at_most"] = *criterion.at_most;
  const bool has = finding != nullptr && finding->figures.contains(criterion.figure);
  out["value"] = has ? json(finding->figures.at(criterion.figure)) : json(nullptr);
  out["met"] = has && is_met(criterion, *finding);
  return out;
}

json hazard_json(const Hazard& h) {
  return {{"id", h.id},
          {"name", h.name},
          {"cause", h.cause},
          {"harm", h.harm},
          {"severity", h.severity},
          {"detection", h.detection},
          {"reaction", h.reaction},
          {"max_time_ms", h.max_time_ms},
          {"requirements", h.requirements},
          {"tests", h.tests}};
}

json risk_json(const Risk& risk) {
  json controls = json::array();
  for (const Control& control : risk.controls)
    controls.push_back({{"kind", control.kind}, {"requirement", control.requirement}});
  return {{"id", risk.id},
          {"hazard", risk.hazard},
          {"severity", risk.severity},
          {"probability_before", risk.before},
          {"probability_after", risk.after},
          {"basis", text_of(risk.basis)},
          {"controls", controls},
          {"residual", text_of(risk.residual)},
          {"open", risk.open}};
}

json requirement_json(const Requirement& requirement, const std::vector<Finding>& findings) {
  json tests = json::array();
  for (const TestResult* test : tests_for(findings, requirement.id)) tests.push_back(test->name);
  return {
      {"id", requirement.id}, {"text", requirement.text}, {"tests", tests}, {"proofs", requirement.proofs}};
}

json finding_json(const Finding& f) {
  return {{"id", f.source},       {"date", f.date},     {"commit", f.commit},   {"code", f.code},
          {"seconds", f.seconds}, {"passed", f.passed}, {"figures", f.figures}, {"tables", f.tables}};
}

}  // namespace

std::string case_json(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                      const std::vector<Gap>& gaps, const Build& build) {
  json out{
      {"version", 1},
      {"claim", safety_case.claim},
      {"passed", gaps.empty()},
      {"quick", build.quick},
      {"build",
       {{"version", build.version}, {"date", build.date}, {"commit", build.commit}, {"code", build.code}}},
      {"figures", {{"total_seconds", build.seconds}}},
      {"bars", json::array()},
      {"gaps", json::array()},
      {"hazards", json::array()},
      {"requirements", json::array()},
      {"risks", json::array()},
      {"evidence", json::array()},
      {"not_covered", safety_case.not_covered},
      {"open", safety_case.open_items}};
  for (const Source& source : safety_case.sources)
    for (const Criterion& criterion : source.criteria) {
      out["bars"].push_back(criterion_json(source, criterion, finding_of(findings, source.id)));
      out["figures"][criterion.name] = out["bars"].back()["value"];
    }
  for (const Gap& gap : gaps) out["gaps"].push_back({{"where", gap.where}, {"what", gap.what}});
  for (const Hazard& hazard : safety_case.hazards) out["hazards"].push_back(hazard_json(hazard));
  for (const Requirement& requirement : safety_case.requirements)
    out["requirements"].push_back(requirement_json(requirement, findings));
  for (const Risk& risk : safety_case.risk.risks) out["risks"].push_back(risk_json(risk));
  for (const Finding& finding : findings) out["evidence"].push_back(finding_json(finding));
  return out.dump(1) + "\n";
}

std::string case_sentence(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                          const std::vector<Gap>& gaps, const Build& build) {
  std::size_t tests = 0;
  for (const Finding& finding : findings) tests += finding.tests.size();
  const std::string scope = fmt::format("{}, {}, {}, {}", counted(safety_case.hazards.size(), "hazard"),
                                        counted(safety_case.requirements.size(), "requirement"),
                                        counted(tests, "test"), counted(findings.size(), "evidence program"));
  const std::size_t n = open_risks(safety_case.risk).size();
  const std::string open = n == 0 ? ""
                                  : fmt::format(" {} not acceptable and open.",
                                                n == 1 ? "1 risk is" : fmt::format("{} risks are", n));
  if (!gaps.empty())
    return fmt::format("The case does not hold: {} in {}.", counted(gaps.size(), "gap"), scope) + open;
  if (build.quick) return fmt::format("No gap in the short subset: {}. It releases nothing.", scope) + open;
  return fmt::format("The case holds for this build: {}, no gap.", scope) + open;
}

}  // namespace biopsy::safety_case
