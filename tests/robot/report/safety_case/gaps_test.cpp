// Claims about the checker of the safety case: every broken link, missing or stale piece of evidence is
// found.
#include "robot/report/safety_case/gaps.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace biopsy::safety_case {
namespace {

struct Whole {
  SafetyCase safety_case;
  std::vector<Finding> findings;
  Build build;
};

// A case without a gap: one hazard, one requirement, a test that names it and a proof within its bar.
Whole whole() {
  Whole w;
  Hazard hazard;
  hazard.id = "H-01";
  hazard.requirements = {"R-01"};
  hazard.tests = {"Suite.Claim"};
  w.safety_case.hazards = {hazard};
  w.safety_case.requirements = {{"R-01", "never", {"proof"}}};
  Source tests{"tests", "Tests", SourceKind::Tests, {"run"}, {}, {}, true, {}};
  Source proof{
      "proof", "Proof", SourceKind::Proof, {"run"}, {}, {}, false, {{"misses", "misses", "", {}, 0.0}}};
  w.safety_case.sources = {tests, proof};
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
};

INSTANTIATE_TEST_SUITE_P(Any, SafetyCaseDamage, testing::ValuesIn(kDamages),
                         [](const auto& damage) { return damage.param.name; });

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
