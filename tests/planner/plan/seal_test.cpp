#include "planner/plan/seal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "robot/common/text/encoding.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::planner {
namespace {

Plan sample_plan() {
  Plan plan;
  plan.target = {"P-7", "1.2.840.1", Point(1, 2, 3), Point(4, 5, 6.5)};
  plan.X_SR.translation() = Point(10, 20, 30);
  plan.registration_fre_mm = 0.25;
  plan.registration_tre_mm = 0.5;
  plan.target_depth = Millimetres(3.5);
  plan.axis_offset = Millimetres(0.125);
  plan.layers = {{"liver", Millimetres(0), Millimetres(9)}};
  plan.steps = {{StepKind::Target, Millimetres(3.5), MillimetresPerSecond(0.5), Volts(6000), Seconds(1.0),
                 true, "target in liver"}};
  plan.limits = {Millimetres(4.5), Volts(6000), {{Volts(500), Millimetres(-0.5), Millimetres(4)}}};
  return plan;
}

TEST(Seal, IsTheSha256OfTheDocumentedSerialisation) {
  Plan plan = sample_plan();
  seal(plan);
  // Computed from the description in seal.hpp with Python's struct and hashlib.
  EXPECT_EQ(hex(plan.seal), "477fead410561ae01c92ab919a2fd984fc87b0328e466aabf8f89891d025b316");
  EXPECT_EQ(plan_tag(plan), 0x477fead410561ae0u);
  EXPECT_TRUE(seal_holds(plan));
}

TEST(Seal, BreaksWithEveryFieldOfTheTipOffset) {
  Plan sealed = sample_plan();
  sealed.tip_offset = TipOffset{"titanium 18 G", "GRE TE 5", Millimetres(4.2), Millimetres(0.3)};
  seal(sealed);
  ASSERT_TRUE(seal_holds(sealed));
  const std::vector<std::function<void(TipOffset&)>> changes = {
      [](TipOffset& o) { o.needle += "."; }, [](TipOffset& o) { o.sequence += "."; },
      [](TipOffset& o) { o.value += Millimetres(0.1); }, [](TipOffset& o) { o.sigma += Millimetres(0.1); }};
  for (const auto& change : changes) {
    Plan plan = sealed;
    change(*plan.tip_offset);
    EXPECT_FALSE(seal_holds(plan));
  }
}

TEST(Seal, AnUnsealedPlanDoesNotHold) {
  EXPECT_FALSE(seal_holds(sample_plan()));
}

TEST(Seal, BreaksWithEverySingleField) {
  verifies("R-50");
  const std::vector<std::function<void(Plan&)>> changes = {
      [](Plan& p) { p.target.patient_id = "P-8"; }, [](Plan& p) { p.target.series_uid = "1.2.840.2"; },
      [](Plan& p) { p.target.p_SE.x() += 0.1; }, [](Plan& p) { p.target.p_SE.y() += 0.1; },
      [](Plan& p) { p.target.p_SE.z() += 0.1; }, [](Plan& p) { p.target.p_ST.x() += 0.1; },
      [](Plan& p) { p.target.p_ST.y() += 0.1; }, [](Plan& p) { p.target.p_ST.z() += 0.1; },
      [](Plan& p) { p.registration_fre_mm += 0.1; }, [](Plan& p) { p.registration_tre_mm += 0.1; },
      [](Plan& p) { p.target_depth += Millimetres(0.1); }, [](Plan& p) { p.axis_offset += Millimetres(0.1); },
      [](Plan& p) { p.layers[0].name = "gap"; }, [](Plan& p) { p.layers[0].from += Millimetres(0.1); },
      [](Plan& p) { p.layers[0].to += Millimetres(0.1); }, [](Plan& p) { p.layers.push_back(p.layers[0]); },
      [](Plan& p) { p.layers.clear(); }, [](Plan& p) { p.steps[0].kind = StepKind::Waypoint; },
      [](Plan& p) { p.steps[0].depth += Millimetres(0.1); },
      [](Plan& p) { p.steps[0].speed += MillimetresPerSecond(0.1); },
      [](Plan& p) { p.steps[0].v_max += Volts(1); }, [](Plan& p) { p.steps[0].dwell += Seconds(0.1); },
      [](Plan& p) { p.steps[0].image_confirms = false; }, [](Plan& p) { p.steps[0].why += "."; },
      [](Plan& p) { p.steps.push_back(p.steps[0]); }, [](Plan& p) { p.steps.clear(); },
      [](Plan& p) { p.tip_offset = TipOffset{}; }, [](Plan& p) { p.gains.proportional_V_per_mm += 1; },
      [](Plan& p) { p.gains.integral_V_per_mm_per_tick += 0.1; },
      [](Plan& p) { p.limits.depth_max += Millimetres(0.1); }, [](Plan& p) { p.limits.v_max += Volts(1); },
      [](Plan& p) { p.limits.plausible[0].drive += Volts(1); },
      [](Plan& p) { p.limits.plausible[0].low -= Millimetres(0.1); },
      [](Plan& p) { p.limits.plausible[0].high += Millimetres(0.1); },
      [](Plan& p) { p.limits.plausible.clear(); }, [](Plan& p) { p.bench = BenchDrive{}; },
      [](Plan& p) { p.bench = BenchDrive{Seconds(0.5)}; },
      [](Plan& p) { p.target_depth = Millimetres(std::nextafter(3.5, 4.0)); },
      // The same characters, divided differently.
      [](Plan& p) { p.target.patient_id = "P-71", p.target.series_uid = ".2.840.1"; }};
  Plan plan = sample_plan();
  seal(plan);
  std::set<std::vector<std::uint8_t>> serialisations = {canonical_bytes(plan)};
  for (std::size_t n = 0; n < changes.size(); ++n) {
    Plan changed = plan;
    changes[n](changed);
    EXPECT_FALSE(seal_holds(changed)) << "change " << n;
    EXPECT_TRUE(serialisations.insert(canonical_bytes(changed)).second) << "change " << n;
  }
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      Plan changed = plan;
      changed.X_SR.matrix()(row, column) += 1e-6;
      EXPECT_FALSE(seal_holds(changed)) << row << ", " << column;
    }
}

TEST(Seal, BreaksWithEveryBitOfItself) {
  verifies("R-50");
  Plan plan = sample_plan();
  seal(plan);
  for (std::size_t bit = 0; bit < 256; ++bit) {
    Plan changed = plan;
    changed.seal[bit / 8] = static_cast<std::uint8_t>(changed.seal[bit / 8] ^ (1u << bit % 8));
    EXPECT_FALSE(seal_holds(changed));
  }
}

TEST(Seal, DoesNotTellMinusZeroFromZero) {
  Plan plan = sample_plan();
  plan.axis_offset = Millimetres(0.0);
  seal(plan);
  plan.axis_offset = Millimetres(-0.0);
  EXPECT_TRUE(seal_holds(plan));
}

}  // namespace
}  // namespace biopsy::planner
