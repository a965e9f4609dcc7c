// Plans that were made elsewhere, by a console that was taken over: each field of a sound plan is changed by
// hand and sealed anew, as such a console would. What a person is shown is read line by line.
#include "planner/plan/plan_review.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "planner/plan/plan_insertion.hpp"
#include "planner/plan/seal.hpp"

namespace biopsy::planner {
namespace {

// An oblique pose: nothing is parallel to a scanner axis.
Plan sound() {
  InsertionRequest request;
  request.X_SR.linear() = Eigen::AngleAxisd(0.7, Point(2, -1, 0.5).normalized()).toRotationMatrix();
  request.X_SR.translation() = Point(12, -40, 77);
  request.target = {"P-9", "1.2.840.9", request.X_SR.translation(), request.X_SR * Point(0.3, -0.4, 3.5)};
  request.registration_fre_mm = 0.4, request.registration_tre_mm = 0.5;
  request.layers = {{"muscle", Millimetres(0), Millimetres(2)}, {"liver", Millimetres(2), Millimetres(25)}};
  request.waypoints = {Millimetres(1.0)};
  request.tip_offset = TipOffset{"titanium 18 G", "GRE TE 5", Millimetres(1.3), Millimetres(0.4)};
  return std::get<Plan>(plan_insertion(request));
}

const Plan kSound = sound();

template <class Change>
Plan changed(const Change& change) {
  Plan plan = kSound;
  change(plan);
  seal(plan);
  return plan;
}

template <class Change>
std::string objection(const Change& change) {
  return objection_to(changed(change)).value_or("");
}

#define EXPECT_OBJECTS(text, ...)                                                      \
  EXPECT_NE(objection([&](Plan& plan) { __VA_ARGS__; }).find(text), std::string::npos) \
      << objection([&](Plan& plan) { __VA_ARGS__; })
#define EXPECT_IN_ORDER(...) EXPECT_EQ(objection([&](Plan& plan) { __VA_ARGS__; }), "")

void move(Millimetres& value, double by_mm) {
  value = Millimetres(value.value + by_mm);
}

const Point kAlong = kSound.X_SR.linear() * Point(0, 0, 1), kBeside = kSound.X_SR.linear() * Point(1, 0, 0);

TEST(PlanReview, ObjectsToNothingInAPlanOfThisProgram) {
  EXPECT_EQ(objection_to(kSound), std::nullopt);
}

TEST(PlanReview, ObjectsWhereThePointsSayAnotherDepthOrPlace) {
  for (const double by_mm : {-4.0, -0.011, 0.011, 4.0, std::nan("")}) {
    EXPECT_OBJECTS("3.50 mm deep", move(plan.target_depth, by_mm));
    EXPECT_OBJECTS("0.50 mm off", move(plan.axis_offset, by_mm));
    EXPECT_OBJECTS("depth limit", move(plan.limits.depth_max, by_mm));
  }
  for (const double by_mm : {-0.011, 0.011, 4.0})
    EXPECT_OBJECTS("last step", move(plan.steps.back().depth, by_mm));
  for (const double by_mm : {-0.009, 0.009}) {
    EXPECT_IN_ORDER(move(plan.steps.back().depth, by_mm));
    EXPECT_IN_ORDER(move(plan.target_depth, by_mm));
    EXPECT_IN_ORDER(move(plan.axis_offset, by_mm));
    EXPECT_IN_ORDER(move(plan.limits.depth_max, by_mm));
  }
  EXPECT_OBJECTS("5.50 mm deep", plan.target.p_ST += 2.0 * kAlong);
  EXPECT_OBJECTS(
      "off the axis", plan.target.p_ST += 2.0 * kBeside;
      plan.axis_offset = Millimetres(std::hypot(2.3, 0.4)));  // they agree, and it is more than may be
}

// With entry and target where they were chosen, a needle said to wait further back goes deeper.
TEST(PlanReview, ObjectsWhereTheNeedleWaitsElsewhereThanAtTheEntry) {
  const auto back = [](Plan& plan, double mm) {
    plan.X_SR.translation() -= mm * kAlong;
    move(plan.target_depth, mm), move(plan.steps.back().depth, mm), move(plan.limits.depth_max, mm);
  };
  EXPECT_OBJECTS("0.99 mm from the entry", back(plan, 0.99));
  EXPECT_OBJECTS("0.51 mm from the entry", back(plan, 0.51));
  EXPECT_OBJECTS("0.51 mm from the entry", back(plan, -0.51));
  EXPECT_IN_ORDER(back(plan, 0.49));
  EXPECT_OBJECTS("0.60 mm from the entry", plan.target.p_SE += 0.6 * kBeside);
  EXPECT_OBJECTS("from the entry", plan.target.p_SE.x() = std::nan(""));
  EXPECT_OBJECTS("transform", plan.X_SR.linear() *= 1.1);
  EXPECT_OBJECTS("transform", plan.X_SR.linear().col(0) *= -1.0);
  EXPECT_OBJECTS("transform", plan.X_SR.translation().y() = std::nan(""));
  for (const double error_mm : {-0.01, 1.01, std::nan("")}) {
    EXPECT_OBJECTS("registration errors", plan.registration_fre_mm = error_mm);
    EXPECT_OBJECTS("registration errors", plan.registration_tre_mm = error_mm);
  }
  EXPECT_IN_ORDER(plan.registration_fre_mm = plan.registration_tre_mm = 1.0);
}

TEST(PlanReview, ObjectsToStepsThatThisProgramDoesNotPlan) {
  for (const std::size_t step : {std::size_t{0}, kSound.steps.size() - 1}) {
    for (const double speed : {-1.0, 0.0, 5.01, 500.0, std::nan("")})
      EXPECT_OBJECTS("mm/s", plan.steps[step].speed = MillimetresPerSecond(speed));
    EXPECT_IN_ORDER(plan.steps[step].speed = kSpeedMax);
    for (const double dwell : {-1.0, 0.0, 10.01, std::nan("")})
      EXPECT_OBJECTS("waits", plan.steps[step].dwell = Seconds(dwell));
    EXPECT_IN_ORDER(plan.steps[step].dwell = kDwellMax);
    for (const double volts : {-1.0, 0.0, 8000.1, std::nan("")})
      EXPECT_OBJECTS("kV", plan.steps[step].v_max = Volts(volts));
    EXPECT_IN_ORDER(plan.steps[step].v_max = plan.limits.v_max = Volts(8000.0));
  }
  EXPECT_OBJECTS("deeper one by one", plan.steps.front().depth = Millimetres(0.0));
  EXPECT_OBJECTS("deeper one by one", plan.steps[1].depth = plan.steps[0].depth);
  EXPECT_OBJECTS("deeper one by one", plan.steps[0].depth = Millimetres(std::nan("")));
  EXPECT_OBJECTS("last step", plan.steps.clear());
  EXPECT_OBJECTS("gains", plan.gains.proportional_V_per_mm = 4000.1);
}

TEST(PlanReview, ObjectsToLayersThatDoNotReachTheTargetAndToAPlanForTheBench) {
  EXPECT_OBJECTS("no tissue layer", plan.layers.clear());
  EXPECT_OBJECTS("no name", plan.layers[0].name = "");
  EXPECT_OBJECTS("end before the target", plan.layers.back().to = plan.target_depth);
  EXPECT_OBJECTS("a b", plan.layers[0].name =
                            "a\x1b"
                            "b";
                 plan.layers[0].from = Millimetres(1.0));
  EXPECT_OBJECTS("x ... (59867 bytes more)", plan.layers[0].name = std::string(60'000, 'x');
                 plan.layers[0].from = Millimetres(1.0));
  EXPECT_OBJECTS("bench", plan.bench = BenchDrive{});
}

// One step to a target there.
void at_depth(Plan& plan, double mm) {
  plan.target.p_ST += (mm - plan.target_depth.value) * kAlong;
  plan.target_depth = Millimetres(mm);
  plan.steps.erase(plan.steps.begin(), plan.steps.end() - 1);
  plan.steps.back().depth = plan.target_depth;
  plan.limits.depth_max = Millimetres(mm + 1.0);
}

TEST(PlanReview, SaysWhatIsWrongWithTheNumbers) {
  EXPECT_OBJECTS("its registration errors, FRE 1.20 and TRE 0.50 mm, are not 0 to 1.0 and 0 to 1.0 mm",
                 plan.registration_fre_mm = 1.2);
  EXPECT_OBJECTS("the target is 3.50 mm deep, and the plan says 4.10 mm",
                 plan.target_depth = Millimetres(4.1));
  EXPECT_OBJECTS("the target is 0.50 mm off the axis, and the plan says 0.70 mm",
                 plan.axis_offset = Millimetres(0.7));
  EXPECT_OBJECTS("more than 0.5 mm: choose", plan.target.p_SE += kBeside);
  EXPECT_OBJECTS("driven at 6.00 mm/s; above 0 and up to 5 are planned",
                 plan.steps[0].speed = MillimetresPerSecond(6.0));
  EXPECT_OBJECTS("waits 11.00 s at its end; above 0 and up to 10 are planned",
                 plan.steps[0].dwell = Seconds(11.0));
  EXPECT_OBJECTS("may use 8.50 kV; above 0 and up to 8 are planned", plan.steps[0].v_max = Volts(8500.0));
  EXPECT_OBJECTS("its depth limit of 5.00 mm is not 1.00 mm beyond the target",
                 plan.limits.depth_max = Millimetres(5.0));
  EXPECT_OBJECTS("its highest drive is 7.50 kV, and of its steps 8.00", plan.steps[0].v_max = Volts(8000.0);
                 plan.limits.v_max = Volts(7500.0));
  EXPECT_OBJECTS("the target is 0.49 mm deep, nearer than 0.5 mm", at_depth(plan, 0.49));
  EXPECT_IN_ORDER(at_depth(plan, 0.51));
  EXPECT_IN_ORDER(plan.steps[0].v_max = Volts(0.5));
  EXPECT_IN_ORDER(for (InsertionStep& step
                       : plan.steps) step.v_max = Volts(0.5);
                  plan.limits.v_max = Volts(0.5));
  EXPECT_IN_ORDER(plan.steps[0].speed = MillimetresPerSecond(0.5));
}

std::string line_of(const Plan& plan, const std::string& beginning) {
  std::istringstream text(review_text(plan));
  for (std::string line; std::getline(text, line);)
    if (line.starts_with(beginning)) return line.substr(14);
  return "no such line";
}

TEST(PlanReview, ShowsWhatThePlanDoesAndIsBoundTo) {
  EXPECT_EQ(line_of(kSound, "patient"), "P-9");
  EXPECT_EQ(line_of(kSound, "series"), "1.2.840.9");
  EXPECT_EQ(line_of(kSound, "entry"),
            "RAS -12.0 40.0 77.0 mm; the tip waits 0.00 mm before it, 0.00 mm beside");
  const Point axis = ras_from_lps(kAlong);
  EXPECT_EQ(line_of(kSound, "tip waits"),
            fmt::format("RAS -12.0 40.0 77.0 mm, pointing to RAS {:.3f} {:.3f} {:.3f}", axis.x(), axis.y(),
                        axis.z()));
  const Point target = ras_from_lps(kSound.target.p_ST);
  EXPECT_EQ(line_of(kSound, "target"),
            fmt::format("RAS {:.1f} {:.1f} {:.1f} mm, {:.2f} mm from the entry", target.x(), target.y(),
                        target.z(), std::hypot(0.3, 0.4, 3.5)));
  EXPECT_EQ(line_of(kSound, "needle goes"),
            "3.50 mm deep, to 0.50 mm beside the target, never beyond 4.50 mm");
  EXPECT_EQ(line_of(kSound, "registration"), "FRE 0.40 mm, TRE 0.50 mm, as the console says");
  EXPECT_EQ(line_of(kSound, "layer         0"), "0.00 to 2.00 mm: muscle");
  EXPECT_EQ(line_of(kSound, "layer         2"), "2.00 to 25.00 mm: liver");
  EXPECT_EQ(line_of(kSound, "gains"), "800 V/mm, 5 V/mm at each tick");
  EXPECT_EQ(line_of(kSound, "tip offset"), "1.30 mm +- 0.40, titanium 18 G in GRE TE 5");
  EXPECT_EQ(line_of(changed([](Plan& plan) {
                      plan.limits.plausible = {{Volts(0.0), Millimetres(-0.5), Millimetres(0.6)},
                                               {Volts(4000.0), Millimetres(1.0), Millimetres(2.0)},
                                               {Volts(8000.0), Millimetres(3.0), Millimetres(9.0)}};
                    }),
                    "plausible"),
            "-0.5 to 0.6 mm at 0.0 kV, 3.0 to 9.0 mm at 8.0 kV");
  for (std::size_t i = 0; i < kSound.steps.size(); ++i) {
    const InsertionStep& step = kSound.steps[i];
    EXPECT_EQ(line_of(kSound, fmt::format("step {} ", i + 1)),
              fmt::format("to {:.2f} mm at {:.2f} mm/s, {:.1f} s there, up to {:.1f} kV{}: {}",
                          step.depth.value, step.speed.value, step.dwell.count(), step.v_max.value * 1e-3,
                          step.image_confirms ? ", then an image" : "", step.why));
  }
}

TEST(PlanReview, ShowsHowFarTheTipIsFromTheEntry) {
  EXPECT_EQ(
      line_of(changed([](Plan& plan) { plan.X_SR.translation() += 0.3 * kAlong + 0.2 * kBeside; }), "entry")
          .substr(24),
      "the tip waits 0.30 mm past it, 0.20 mm beside");
  EXPECT_EQ(line_of(changed([](Plan& plan) { plan.X_SR.translation() -= 0.3 * kAlong; }), "entry").substr(24),
            "the tip waits 0.30 mm before it, 0.00 mm beside");
}

TEST(PlanReview, SaysPastTheEntryWhereThatIsNotRoundedAway) {
  const auto entry = [](double past_mm) {
    return line_of(changed([&](Plan& plan) { plan.X_SR.translation() += past_mm * kAlong; }), "entry")
        .substr(24, 24);
  };
  EXPECT_EQ(entry(0.0055), "the tip waits 0.01 mm pa");
  EXPECT_EQ(entry(0.0045), "the tip waits 0.00 mm be");
}

TEST(PlanReview, ShowsWhatIsAbsentAndNothingThatHides) {
  const Plan bare = changed([](Plan& plan) {
    plan.registration_fre_mm = plan.registration_tre_mm = 0.0;
    plan.tip_offset.reset();
    plan.limits.plausible.clear();
    plan.target.patient_id = std::string(64, 'a') + "bcd";
    plan.target.series_uid = "";
    plan.layers[0].name = "gap\nneedle goes   1.00 mm deep";
  });
  EXPECT_EQ(line_of(bare, "registration"),
            "no errors measured: where the guide was aimed, or as it was given");
  EXPECT_EQ(line_of(changed([](Plan& plan) { plan.registration_tre_mm = 0.0; }), "registration"),
            "FRE 0.40 mm, TRE 0.00 mm, as the console says");
  EXPECT_EQ(line_of(changed([](Plan& plan) { plan.registration_fre_mm = 0.0; }), "registration"),
            "no errors measured: where the guide was aimed, or as it was given");
  EXPECT_EQ(line_of(bare, "tip offset"), "none: no image is accepted");
  EXPECT_EQ(line_of(bare, "plausible"), "nothing");
  EXPECT_EQ(line_of(bare, "patient"), std::string(64, 'a') + " ... (3 bytes more)");
  EXPECT_EQ(line_of(bare, "series"), "(none)");
  EXPECT_EQ(line_of(bare, "layer         0"), "0.00 to 2.00 mm: gap needle goes   1.00 mm deep");
  EXPECT_EQ(line_of(bare, "needle goes"), "3.50 mm deep, to 0.50 mm beside the target, never beyond 4.50 mm");
  EXPECT_EQ(line_of(changed([](Plan& plan) { plan.target.patient_id = std::string(64, 'a'); }), "patient"),
            std::string(64, 'a'));
}

}  // namespace
}  // namespace biopsy::planner
