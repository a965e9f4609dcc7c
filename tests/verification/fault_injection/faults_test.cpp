// The quick subset of fault injection, class by class; and that this bench can fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "tests/safety/verifies.hpp"
#include "tests/source_dir.hpp"
#include "tests/verification/fault_injection/campaign.hpp"
#include "tests/verification/fault_injection/trace_text.hpp"

namespace biopsy::fault_injection {

void PrintTo(const FaultClass& fault, std::ostream* out) {
  *out << fault.id << ' ' << fault.what;
}

namespace {

const NominalModels& models() {
  static const NominalModels kOpened = read_nominal_models(source_dir() / "sim/models");
  return kOpened;
}

Tally tally_of(const Campaign& campaign, const FaultClass& fault, std::int32_t runs) {
  return run_all(campaign, {fault}, runs, [](double) {}).front();
}

class EveryFault : public testing::TestWithParam<FaultClass> {};

TEST_P(EveryFault, IsDetectedAndStoppedInTimeWithinDepthAndVoltage) {
  constexpr std::int32_t kRuns = 12;
  const FaultClass& fault = GetParam();
  if (fault.hazard != safety::Hazard::None) verifies(fault.id.substr(0, 4));
  const Campaign campaign{models()};
  const Tally tally = tally_of(campaign, fault, kRuns);
  EXPECT_TRUE(tally.holds())
      << trace_text(fault, run_one(campaign, fault, tally.bad.front())).substr(0, 4'000);
}

TEST_P(EveryFault, IsMissedWhereItsHazardsAreMasked) {
  const FaultClass& fault = GetParam();
  if (fault.hazard == safety::Hazard::None) GTEST_SKIP() << "noticed without a detector";
  Campaign masked_campaign{models()};
  masked_campaign.masked = bit(fault.hazard) | fault.instead;
  EXPECT_FALSE(tally_of(masked_campaign, fault, 2).holds());
}

std::string name_of_class(const testing::TestParamInfo<FaultClass>& fault) {
  std::string name = fault.param.id;
  std::erase_if(name, [](char c) { return c == '-' || c == '/'; });
  return name;
}

INSTANTIATE_TEST_SUITE_P(Class, EveryFault, testing::ValuesIn(all_faults()), name_of_class);

TEST(FaultClasses, CoverEveryHazardOfTheTable) {
  safety::HazardSet covered = 0;
  for (const FaultClass& fault : all_faults())
    if (fault.hazard != safety::Hazard::None) covered |= bit(fault.hazard);
  EXPECT_EQ(covered, safety::kAllHazards);
}

TEST(Coverage, Of299RunsWithoutAMissIs99PerCentAt95PerCentConfidence) {
  EXPECT_NEAR(lower_bound_95(299, 299), 0.990, 0.0001);
  EXPECT_NEAR(lower_bound_95(12, 12), std::pow(0.05, 1.0 / 12.0), 1e-6);
  EXPECT_LT(lower_bound_95(298, 299), 0.985);
  EXPECT_EQ(lower_bound_95(0, 299), 0.0);
}

TEST(Injection, IsTheSameAgain) {
  const FaultClass fault = all_faults().front();
  const Campaign campaign{models()};
  const RunResult once = run_one(campaign, fault, 3), again = run_one(campaign, fault, 3);
  ASSERT_EQ(once.lines.size(), again.lines.size());
  EXPECT_EQ(once.tick, again.tick);
  EXPECT_EQ(once.lines.back().depth_mm, again.lines.back().depth_mm);
}

// A run by hand: shown from the third line, named in the fifth, off in the sixth.
std::vector<TickRecord> six_lines() {
  std::vector<TickRecord> lines(8);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    lines[i].mode = i < 5 ? Mode::Active : Mode::Trip;
    lines[i].shown = i >= 2;
    lines[i].hazards = i >= 4 ? bit(safety::Hazard::EStop) : 0;
    lines[i].command_mV = i < 5 ? 3'000'000 : 0;
    lines[i].output_kV = lines[i].command_mV * 1e-6;
    lines[i].enabled = i < 5;
    lines[i].depth_mm = 2.0;
  }
  return lines;
}

TEST(Evaluate, CountsFromTheFirstSampleThatShowsIt) {
  FaultClass fault = class_of(safety::Hazard::EStop);
  fault.detect_ms = 3, fault.react_ms = 4;
  const Verdict verdict = evaluate(fault, six_lines(), 1.5);
  EXPECT_EQ(verdict.outcome, Outcome::Detected);
  EXPECT_EQ(verdict.detect_ms, 3);
  EXPECT_EQ(verdict.react_ms, 4);
  EXPECT_EQ(verdict.from_fault_ms, 6);
  EXPECT_DOUBLE_EQ(verdict.beyond_mm, 0.5);
  EXPECT_DOUBLE_EQ(verdict.highest_kV, 3.0);
}

TEST(Evaluate, CallsLateWhatIsLate) {
  FaultClass fault = class_of(safety::Hazard::EStop);
  fault.detect_ms = 2;
  EXPECT_EQ(evaluate(fault, six_lines(), 1.5).outcome, Outcome::Late);
  fault.detect_ms = 3, fault.react_ms = 3;
  EXPECT_EQ(evaluate(fault, six_lines(), 1.5).outcome, Outcome::Late);
}

TEST(Evaluate, CallsMissedWhatWasNeverNamedOrNeverStopped) {
  FaultClass fault = class_of(safety::Hazard::EStop);
  std::vector<TickRecord> unnamed = six_lines(), driven = six_lines();
  for (TickRecord& line : unnamed) line.hazards = 0;
  for (TickRecord& line : driven) line.enabled = true;
  EXPECT_EQ(evaluate(fault, unnamed, 1.5).outcome, Outcome::Missed);
  EXPECT_EQ(evaluate(fault, driven, 1.5).outcome, Outcome::Missed);
}

TEST(Evaluate, SeesAVoltageThatComesBack) {
  FaultClass fault = class_of(safety::Hazard::EStop);
  std::vector<TickRecord> lines = six_lines();
  EXPECT_FALSE(evaluate(fault, lines, 1.5).rose);
  lines.back().command_mV = 1'000;
  EXPECT_TRUE(evaluate(fault, lines, 1.5).rose);
}

}  // namespace
}  // namespace biopsy::fault_injection
