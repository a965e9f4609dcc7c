#include "robot/report/safety_case/risk_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace biopsy::safety_case {
namespace {

using RiskIds = std::set<std::string>;

template <class Items>
RiskIds checked_ids(const Items& items, std::vector<Gap>& gaps) {
  RiskIds ids;
  for (const auto& item : items)
    if (!ids.insert(item.id).second) gaps.push_back({item.id, "appears twice in the risk management file"});
  return ids;
}

template <class Items>
RiskIds known_ids(const Items& items) {
  RiskIds ids;
  for (const auto& item : items) ids.insert(item.id);
  return ids;
}

class RiskChecks {
 public:
  explicit RiskChecks(const SafetyCase& safety_case)
      : safety_case_(safety_case),
        hazards_(known_ids(safety_case.hazards)),
        requirements_(known_ids(safety_case.requirements)),
        sources_(known_ids(safety_case.sources)) {}

  std::vector<Gap> run() {
    const RiskFile& file = safety_case_.risk;
    checked_ids(file.risks, gaps_);
    checked_ids(file.items, gaps_);
    for (const Risk& risk : file.risks) check(risk);
    for (const Hazard& hazard : safety_case_.hazards) check_hazard(hazard);
    check_tested(file.threats);
    check_tested(file.scenarios);
    return std::move(gaps_);
  }

 private:
  void gap(const std::string& where, std::string what) { gaps_.push_back({where, std::move(what)}); }

  void expect_hazard(const std::string& where, const std::string& hazard) {
    if (!hazards_.contains(hazard)) gap(where, fmt::format("{} is no hazard", hazard));
  }

  void check(const Risk& risk) {
    expect_hazard(risk.id, risk.hazard);
    const Acceptability verdict = safety_case_.risk.matrix.at(risk.severity, risk.after);
    if (verdict != risk.residual)
      gap(risk.id,
          fmt::format("says \"{}\", the matrix says \"{}\"", text_of(risk.residual), text_of(verdict)));
    const bool is_open = verdict == Acceptability::NotAcceptable;
    if (is_open != !risk.open.empty())
      gap(risk.id,
          is_open ? "is not acceptable and does not say what is missing" : "is open though acceptable");
    if (risk.after > risk.before) gap(risk.id, "its controls make the harm more probable");
    if (risk.after < risk.before && risk.controls.empty())
      gap(risk.id, "is less probable without any control");
    if (risk.basis == Basis::Unknown && risk.after != kRiskLevels)
      gap(risk.id, "a probability that is unknown counts as the highest");
    if ((risk.basis == Basis::Measured) == risk.evidence.empty())
      gap(risk.id, "what is measured names its evidence, and nothing else does");
    for (const std::string& id : risk.evidence)
      if (!sources_.contains(id)) gap(risk.id, fmt::format("{} is no source of evidence", id));
    for (const Control& control : risk.controls)
      if (!requirements_.contains(control.requirement))
        gap(risk.id, fmt::format("{} is not a requirement", control.requirement));
    for (const std::string& caused : risk.new_risks)
      if (caused.starts_with("H-")) expect_hazard(risk.id, caused.substr(0, caused.find(' ')));
  }

  bool has_open_risk(const std::string& hazard) const {
    const std::vector<Risk>& risks = safety_case_.risk.risks;
    return std::any_of(risks.begin(), risks.end(), [&](const Risk& risk) {
      return risk.hazard == hazard && risk.residual == Acceptability::NotAcceptable;
    });
  }

  void check_hazard(const Hazard& hazard) {
    RiskIds controls;
    bool has_risk = false;
    for (const Risk& risk : safety_case_.risk.risks) {
      if (risk.hazard != hazard.id) continue;
      has_risk = true;
      for (const Control& control : risk.controls) controls.insert(control.requirement);
    }
    if (!has_risk) return gap(hazard.id, "has no risk");
    for (const std::string& requirement : hazard.requirements)
      if (!controls.contains(requirement))
        gap(hazard.id, fmt::format("{} controls none of its risks", requirement));
    if (hazard.requirements.empty() && !has_open_risk(hazard.id))
      gap(hazard.id, "has no requirement, and no open risk");
  }

  template <class Items>
  void check_tested(const Items& items) {
    checked_ids(items, gaps_);
    for (const auto& item : items) {
      expect_hazard(item.id, item.hazard);
      if (item.tests.empty() && !item.open) gap(item.id, "has no test and is not declared open");
      if (item.open && !has_open_risk(item.hazard))
        gap(item.id, fmt::format("is open, and no risk of {} is", item.hazard));
    }
  }

  const SafetyCase& safety_case_;
  RiskIds hazards_, requirements_, sources_;
  std::vector<Gap> gaps_;
};

}  // namespace

std::string text_of(Acceptability acceptability) {
  switch (acceptability) {
    case Acceptability::Acceptable:
      return "acceptable";
    case Acceptability::Tolerable:
      return "tolerable";
    case Acceptability::NotAcceptable:
      return "not acceptable, open";
  }
  return "not acceptable, open";
}

std::optional<Acceptability> acceptability_from(const std::string& text) {
  for (const Acceptability value :
       {Acceptability::Acceptable, Acceptability::Tolerable, Acceptability::NotAcceptable})
    if (text_of(value) == text) return value;
  return std::nullopt;
}

std::string text_of(Basis basis) {
  return basis == Basis::Measured ? "measured" : basis == Basis::Estimated ? "estimated" : "unknown";
}

Acceptability RiskMatrix::at(int severity_level, int probability_level) const {
  return verdicts.at(static_cast<std::size_t>(severity_level - 1))
      .at(static_cast<std::size_t>(probability_level - 1));
}

std::vector<Gap> gaps_in_risks(const SafetyCase& safety_case) {
  return RiskChecks(safety_case).run();
}

std::vector<const Risk*> open_risks(const RiskFile& file) {
  std::vector<const Risk*> open;
  for (const Risk& risk : file.risks)
    if (risk.residual == Acceptability::NotAcceptable) open.push_back(&risk);
  return open;
}

}  // namespace biopsy::safety_case
