// Claims about the checker of the safety case: every broken link, missing or stale piece of evidence is
// found.
#include "robot/report/safety_case/gaps.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "robot/report/safety_case/case_page.hpp"
#include "robot/report/safety_case/risk_document.hpp"

namespace biopsy::safety_case {
namespace {

struct Whole {
  SafetyCase safety_case;
  std::vector<Finding> findings;
  Build build;
};

// Rare is tolerable, and what is worse is not acceptable.
RiskMatrix matrix() {
  RiskMatrix matrix;
  for (auto& row : matrix.verdicts) row.fill(Acceptability::NotAcceptable);
  for (auto& row : matrix.verdicts) row[0] = row[1] = Acceptability::Tolerable;
  return matrix;
}

Risk risk() {
  Risk risk;
  risk.id = "RISK-01";
  risk.hazard = "H-01";
  risk.severity = 5;
  risk.before = 4;
  risk.after = 2;
  risk.basis = Basis::Measured;
  risk.evidence = {"proof"};
  risk.controls = {{"protective", "R-01"}};
  risk.residual = Acceptability::Tolerable;
  return risk;
}

// A case without a gap: one hazard with its risk, one requirement, a test that names it and a proof within
// its bar.
Whole whole() {
  Whole w;
  Hazard hazard;
  hazard.id = "H-01";
  hazard.requirements = {"R-01"};
  hazard.tests = {"Suite.Claim"};
  w.safety_case.hazards = {hazard};
  w.safety_case.requirements = {{"R-01", "never", {"proof"}}};
  Source tests, proof;
  tests.id = "tests", tests.title = "Tests", tests.kind = SourceKind::Tests, tests.command = {"run"};
  proof.id = "proof", proof.title = "Proof", proof.kind = SourceKind::Proof, proof.command = {"run"};
  proof.in_quick = false;
  proof.criteria = {{"misses", "misses", "", {}, 0.0}};
  w.safety_case.sources = {tests, proof};
  w.safety_case.risk.matrix = matrix();
  w.safety_case.risk.risks = {risk()};
  w.build.code = "abc";
  Finding tested{.source = "tests", .date = {}, .commit = {}, .code = "abc", .passed = true};
  tested.tests = {{"Suite.Claim", true, {"R-01"}}};
  Finding proven{.source = "proof", .date = {}, .commit = {}, .code = "abc", .passed = true};
  proven.figures["misses"] = 0.0;
  w.findings = {tested, proven};
  return w;
}

std::vector<Gap> gaps_of(const Whole& w) {
  std::vector<Gap> gaps = gaps_in_argument(w.safety_case);
  for (const Gap& gap : gaps_in_evidence(w.safety_case, w.findings, w.build)) gaps.push_back(gap);
  return gaps;
}

struct Damage {
  const char* name;
  std::function<void(Whole&)> corrupt;
  const char* where;  // of a gap that must be found
};

class SafetyCaseDamage : public testing::TestWithParam<Damage> {};

TEST_P(SafetyCaseDamage, IsFoundAndSaysWhere) {
  Whole w = whole();
  ASSERT_TRUE(gaps_of(w).empty());
  GetParam().corrupt(w);
  const std::vector<Gap> gaps = gaps_of(w);
  ASSERT_FALSE(gaps.empty());
  bool said = false;
  for (const Gap& gap : gaps) said = said || gap.where == GetParam().where;
  EXPECT_TRUE(said) << gaps.front().where << ": " << gaps.front().what;
}

const Damage kDamages[] = {
    {"HazardTwice", [](Whole& w) { w.safety_case.hazards.push_back(w.safety_case.hazards[0]); }, "H-01"},
    {"HazardWithoutRequirement", [](Whole& w) { w.safety_case.hazards[0].requirements.clear(); }, "H-01"},
    {"HazardWithoutTest", [](Whole& w) { w.safety_case.hazards[0].tests.clear(); }, "H-01"},
    {"LinkToNoRequirement", [](Whole& w) { w.safety_case.hazards[0].requirements.push_back("R-99"); },
     "H-01"},
    {"RequirementNobodyNeeds",
     [](Whole& w) {
       w.safety_case.requirements.push_back({"R-02", "", {}});
     },
     "R-02"},
    {"LinkToNoSource", [](Whole& w) { w.safety_case.requirements[0].proofs = {"nothing"}; }, "R-01"},
    {"RequirementWithoutTest", [](Whole& w) { w.findings[0].tests[0].verifies.clear(); }, "R-01"},
    {"OnlyTestFailed", [](Whole& w) { w.findings[0].tests[0].passed = false; }, "R-01"},
    {"TestFailed",
     [](Whole& w) {
       w.findings[0].tests.push_back({"Suite.Other", false, {}});
     },
     "Suite.Other"},
    {"TestOfUnknownRequirement", [](Whole& w) { w.findings[0].tests[0].verifies.push_back("R-77"); },
     "Suite.Claim"},
    {"HazardsTestNotRun", [](Whole& w) { w.safety_case.hazards[0].tests = {"Suite.Gone"}; }, "H-01"},
    {"HazardsTestNamesAnother",
     [](Whole& w) {
       w.findings[0].tests.push_back({"Suite.Unrelated", true, {}});
       w.safety_case.hazards[0].tests = {"Suite.Unrelated"};
     },
     "H-01"},
    {"NoEvidence", [](Whole& w) { w.findings.pop_back(); }, "proof"},
    {"StaleEvidence", [](Whole& w) { w.findings[1].code = "abd"; }, "proof"},
    {"FailedProof", [](Whole& w) { w.findings[1].passed = false; }, "proof"},
    {"OnlyTheShortSubset", [](Whole& w) { w.findings[1].quick = true; }, "proof"},
    {"BelowItsBar", [](Whole& w) { w.findings[1].figures["misses"] = 1.0; }, "proof"},
    {"FigureMissing", [](Whole& w) { w.findings[1].figures.clear(); }, "proof"},
    {"HazardWithoutRisk", [](Whole& w) { w.safety_case.risk.risks.clear(); }, "H-01"},
    {"RiskTwice", [](Whole& w) { w.safety_case.risk.risks.push_back(risk()); }, "RISK-01"},
    {"RiskOfNoHazard", [](Whole& w) { w.safety_case.risk.risks[0].hazard = "H-99"; }, "RISK-01"},
    {"RequirementThatControlsNoRisk",
     [](Whole& w) {
       w.safety_case.risk.risks[0].controls.clear();
       w.safety_case.risk.risks[0].after = 4;
     },
     "H-01"},
    {"ControlThatIsNoRequirement",
     [](Whole& w) {
       w.safety_case.risk.risks[0].controls.push_back({"inherent", "R-98"});
     },
     "RISK-01"},
    {"RiskLessProbableWithoutAControl", [](Whole& w) { w.safety_case.risk.risks[0].controls.clear(); },
     "RISK-01"},
    {"RiskMoreProbableByItsControls", [](Whole& w) { w.safety_case.risk.risks[0].before = 1; }, "RISK-01"},
    {"KinderThanTheMatrix",
     [](Whole& w) { w.safety_case.risk.risks[0].residual = Acceptability::Acceptable; }, "RISK-01"},
    {"HarsherThanTheMatrix",
     [](Whole& w) { w.safety_case.risk.risks[0].residual = Acceptability::NotAcceptable; }, "RISK-01"},
    {"MatrixThatTightened",
     [](Whole& w) { w.safety_case.risk.matrix.verdicts[4][1] = Acceptability::NotAcceptable; }, "RISK-01"},
    {"OpenRiskThatDoesNotSayWhatIsMissing",
     [](Whole& w) {
       w.safety_case.risk.risks[0].after = 4;
       w.safety_case.risk.risks[0].residual = Acceptability::NotAcceptable;
     },
     "RISK-01"},
    {"OpenThoughAcceptable", [](Whole& w) { w.safety_case.risk.risks[0].open = "a sensor"; }, "RISK-01"},
    {"UnknownTakenForRare",
     [](Whole& w) {
       w.safety_case.risk.risks[0].basis = Basis::Unknown;
       w.safety_case.risk.risks[0].evidence.clear();
     },
     "RISK-01"},
    {"MeasuredByNothing", [](Whole& w) { w.safety_case.risk.risks[0].evidence.clear(); }, "RISK-01"},
    {"MeasuredByNoSource", [](Whole& w) { w.safety_case.risk.risks[0].evidence = {"nothing"}; }, "RISK-01"},
    {"NewRiskThatIsNoHazard", [](Whole& w) { w.safety_case.risk.risks[0].new_risks = {"H-97"}; }, "RISK-01"},
    {"ThreatWithoutTest",
     [](Whole& w) {
       w.safety_case.risk.threats = {{"T-01", "", "", "H-01", "", {}, "", false}};
     },
     "T-01"},
    {"OpenThreatOfARiskThatIsNot",
     [](Whole& w) {
       w.safety_case.risk.threats = {{"T-02", "", "", "H-01", "", {}, "", true}};
     },
     "T-02"},
    {"ScenarioOfNoHazard",
     [](Whole& w) {
       w.safety_case.risk.scenarios = {{"U-01", "", "", "", "H-96", "", {"Suite.Claim"}, "", false}};
     },
     "U-01"},
};

INSTANTIATE_TEST_SUITE_P(Any, SafetyCaseDamage, testing::ValuesIn(kDamages),
                         [](const auto& damage) { return damage.param.name; });

// A hazard against which nothing is done is no hole in the argument where its risk says so; it is shown.
TEST(SafetyCase, AnOpenRiskNeedsNoControlAndIsShown) {
  Whole w = whole();
  Hazard hazard;
  hazard.id = "H-02";
  w.safety_case.hazards.push_back(hazard);
  Risk open = risk();
  open.id = "RISK-02";
  open.hazard = "H-02";
  open.before = open.after = 5;
  open.controls.clear();
  open.evidence.clear();
  open.basis = Basis::Unknown;
  open.residual = Acceptability::NotAcceptable;
  open.open = "a measurement of the temperature";
  w.safety_case.risk.risks.push_back(open);
  EXPECT_TRUE(gaps_of(w).empty()) << gaps_of(w).front().what;
  EXPECT_NE(case_sentence(w.safety_case, w.findings, {}, w.build).find("1 risk is not acceptable and open"),
            std::string::npos);
  const std::string page = case_html(w.safety_case, w.findings, {}, w.build, "");
  const std::size_t shown = page.find("RISK-02 (H-02), not acceptable: a measurement of the temperature");
  EXPECT_LT(shown, page.find("<h2>Hazards</h2>")) << "not on the first screen";
}

TEST(RiskDocument, KeepsTextsFromBecomingMarkup) {
  Whole w = whole();
  w.safety_case.risk.threats = {{"T-01", "a | b", "<script>", "H-01", "*", {"Suite.Claim"}, "", false}};
  const std::string markdown = risk_markdown(w.safety_case), html = risk_html(w.safety_case);
  EXPECT_NE(markdown.find("| T-01 a \\| b | \\<script> | H-01 | \\* | Suite.Claim | |"), std::string::npos)
      << markdown;
  EXPECT_EQ(html.find("<script>"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
}

TEST(SafetyCase, AQuickBuildAsksForItsSubsetOnlyAndJudgesNoBar) {
  Whole w = whole();
  w.build.quick = true;
  w.findings.pop_back();
  EXPECT_TRUE(gaps_of(w).empty());
  w.findings[0].tests[0].passed = false;
  EXPECT_FALSE(gaps_of(w).empty());
}

}  // namespace
}  // namespace biopsy::safety_case
