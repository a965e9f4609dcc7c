#include "robot/report/safety_case/gaps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "robot/report/safety_case/risk_checks.hpp"

namespace biopsy::safety_case {
namespace {

using Ids = std::set<std::string>;

template <class Items>
Ids ids_of(const Items& items, std::vector<Gap>& gaps) {
  Ids ids;
  for (const auto& item : items)
    if (!ids.insert(item.id).second) gaps.push_back({item.id, "appears twice in the case"});
  return ids;
}

bool names_any(const TestResult& test, const std::vector<std::string>& requirements) {
  return std::any_of(requirements.begin(), requirements.end(), [&](const std::string& id) {
    return std::find(test.verifies.begin(), test.verifies.end(), id) != test.verifies.end();
  });
}

const TestResult* test_named(const std::vector<Finding>& findings, const std::string& name) {
  for (const Finding& finding : findings)
    for (const TestResult& test : finding.tests)
      if (test.name == name) return &test;
  return nullptr;
}

void check_tests(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                 std::vector<Gap>& gaps) {
  Ids known;
  for (const Requirement& requirement : safety_case.requirements) known.insert(requirement.id);
  for (const Finding& finding : findings)
    for (const TestResult& test : finding.tests) {
      if (!test.passed) gaps.push_back({test.name, "failed or was not judged"});
      for (const std::string& id : test.verifies)
        if (!known.contains(id))
          gaps.push_back({test.name, fmt::format("names {}, which is no requirement", id)});
    }
  for (const Hazard& hazard : safety_case.hazards)
    for (const std::string& name : hazard.tests) {
      const TestResult* test = test_named(findings, name);
      if (test == nullptr)
        gaps.push_back({hazard.id, fmt::format("its test {} was not run", name)});
      else if (!names_any(*test, hazard.requirements))
        gaps.push_back({hazard.id, fmt::format("its test {} names none of its requirements", name)});
    }
}

bool is_asked_for(const Source& source, const Build& build) {
  return !build.quick || source.in_quick;
}

void check_source(const Source& source, const Finding* finding, const Build& build, std::vector<Gap>& gaps) {
  if (finding == nullptr) return gaps.push_back({source.id, "no evidence"});
  if (finding->code != build.code)
    gaps.push_back({source.id, fmt::format("evidence of {} is of other code", finding->date)});
  if (!finding->passed) gaps.push_back({source.id, "failed"});
  if (!build.quick && finding->quick) gaps.push_back({source.id, "only the short subset was run"});
  if (build.quick) return;
  for (const Criterion& criterion : source.criteria)
    if (!is_met(criterion, *finding)) {
      const auto figure = finding->figures.find(criterion.figure);
      gaps.push_back({source.id, figure == finding->figures.end()
                                     ? fmt::format("has no figure {}", criterion.figure)
                                     : fmt::format("{} is {:g}, outside its acceptance criterion",
                                                   criterion.name, figure->second)});
    }
}

}  // namespace

std::vector<Gap> gaps_in_argument(const SafetyCase& safety_case) {
  std::vector<Gap> gaps;
  ids_of(safety_case.hazards, gaps);
  const Ids requirements = ids_of(safety_case.requirements, gaps),
            sources = ids_of(safety_case.sources, gaps);
  Ids needed;
  for (const Hazard& hazard : safety_case.hazards) {
    if (hazard.tests.empty() && !hazard.requirements.empty()) gaps.push_back({hazard.id, "has no test"});
    for (const std::string& id : hazard.requirements) {
      needed.insert(id);
      if (!requirements.contains(id)) gaps.push_back({hazard.id, fmt::format("{} is not a requirement", id)});
    }
  }
  for (const Requirement& requirement : safety_case.requirements) {
    if (!needed.contains(requirement.id)) gaps.push_back({requirement.id, "no hazard needs it"});
    for (const std::string& id : requirement.proofs)
      if (!sources.contains(id))
        gaps.push_back({requirement.id, fmt::format("{} is no source of evidence", id)});
  }
  for (const Gap& gap : gaps_in_risks(safety_case)) gaps.push_back(gap);
  return gaps;
}

std::vector<Gap> gaps_in_evidence(const SafetyCase& safety_case, const std::vector<Finding>& findings,
                                  const Build& build) {
  std::vector<Gap> gaps;
  for (const Source& source : safety_case.sources)
    if (is_asked_for(source, build)) check_source(source, finding_of(findings, source.id), build, gaps);
  check_tests(safety_case, findings, gaps);
  for (const Requirement& requirement : safety_case.requirements)
    if (tests_for(findings, requirement.id).empty())
      gaps.push_back({requirement.id, "no passed test names it"});
  return gaps;
}

bool is_met(const Criterion& criterion, const Finding& finding) {
  const auto figure = finding.figures.find(criterion.figure);
  if (figure == finding.figures.end()) return false;
  const double value = figure->second;
  return (!criterion.at_least || value >= *criterion.at_least) &&
         (!criterion.at_most || value <= *criterion.at_most);
}

const Finding* finding_of(const std::vector<Finding>& findings, const std::string& source) {
  for (const Finding& finding : findings)
    if (finding.source == source) return &finding;
  return nullptr;
}

std::vector<const TestResult*> tests_for(const std::vector<Finding>& findings,
                                         const std::string& requirement) {
  std::vector<const TestResult*> tests;
  for (const Finding& finding : findings)
    for (const TestResult& test : finding.tests)
      if (test.passed && names_any(test, {requirement})) tests.push_back(&test);
  return tests;
}

}  // namespace biopsy::safety_case
