// Claims about reading evidence: gtest's own JSON, proofs, and findings that were kept.
#include "robot/report/safety_case/finding_json.hpp"

#include <gtest/gtest.h>

#include <random>

#include "robot/common/config_error.hpp"

namespace biopsy::safety_case {
namespace {

constexpr const char* kTests = R"({"testsuites": [{"name": "Any/Suite", "testsuite": [
  {"name": "Claim/R01", "status": "RUN", "result": "COMPLETED", "time": "0.5s", "verifies": "R-01,R-02", "worst_ms": "3.5"},
  {"name": "Late/R01", "status": "RUN", "result": "COMPLETED", "worst_ms": "4.25"},
  {"name": "Broken", "status": "RUN", "result": "COMPLETED", "failures": [{"failure": "no"}]},
  {"name": "Skipped", "status": "RUN", "result": "SKIPPED"},
  {"name": "Off", "status": "NOTRUN", "result": "SUPPRESSED"}]}]})";

constexpr const char* kProof = R"({"tool": "explore", "passed": true, "figures": {"transitions": 12000000},
  "tables": {"bugs": [{"id": "B-1", "caught_by": "trip latches", "ticks": 3}]}})";

TEST(Findings, ATestThatFailedWasSkippedOrNotRunHasNotPassed) {
  Finding finding;
  read_tests(kTests, "tests.json", finding);
  ASSERT_EQ(finding.tests.size(), 5U);
  EXPECT_EQ(finding.tests[0].name, "Any/Suite.Claim/R01");
  EXPECT_TRUE(finding.tests[0].passed);
  EXPECT_EQ(finding.tests[0].verifies, (std::vector<std::string>{"R-01", "R-02"}));
  for (std::size_t i = 2; i < 5; ++i) EXPECT_FALSE(finding.tests[i].passed) << finding.tests[i].name;
  EXPECT_FALSE(finding.passed);
}

TEST(Findings, OfNumbersThatTestsRecordTheLargestCounts) {
  Finding finding;
  read_tests(kTests, "tests.json", finding);
  EXPECT_EQ(finding.figures.at("worst_ms"), 4.25);
  EXPECT_EQ(finding.figures.at("failed"), 3.0);
  EXPECT_EQ(finding.figures.count("time"), 0U);
}

TEST(Findings, ARunWithoutAnyTestProvesNothing) {
  Finding finding;
  read_tests(R"({"testsuites": []})", "tests.json", finding);
  EXPECT_FALSE(finding.passed);
}

TEST(Findings, ComeBackAsTheyWereKept) {
  Finding finding{.source = "explore", .date = "2031-05-17T09:30:00Z", .commit = "c0ffee", .code = "ab"};
  finding.seconds = 12.5;
  finding.quick = true;
  read_proof(kProof, "proof.json", finding);
  finding.tests = {{"Suite.Claim", true, {"R-01"}}};
  const Finding back = finding_from_json(to_json(finding), "kept.json");
  EXPECT_EQ(to_json(back), to_json(finding));
  EXPECT_EQ(back.figures.at("transitions"), 1.2e7);
  EXPECT_EQ(back.tables.at("bugs").front().at("caught_by"), "trip latches");
  EXPECT_EQ(back.tables.at("bugs").front().at("ticks"), "3");
}

TEST(Findings, SurviveAnyBytesAndNameTheFile) {
  std::mt19937 random(11);
  const std::string whole = kProof;
  for (int i = 0; i < 2'000; ++i) {
    std::string text = whole.substr(0, random() % (whole.size() + 1));
    for (int flips = 0; flips < 3 && !text.empty(); ++flips)
      text[random() % text.size()] = static_cast<char>(random() % 256);
    Finding finding;
    try {
      read_proof(text, "proof.json", finding);
      read_tests(text, "proof.json", finding);
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.where, "proof.json");
    }
  }
}

}  // namespace
}  // namespace biopsy::safety_case
