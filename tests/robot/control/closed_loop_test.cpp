// The controller on the plant. A finding that the documentation states: the bare baseline is a spring with a
// damping ratio of 0.1, and the paper's gains do not hold it; the friction of the rehearsal's stage is what
// lets them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "robot/control/step_runner.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/plant.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::control {
namespace {

struct Trace {
  std::vector<double> depth_mm;  // true, one a tick
  std::vector<double> drive_V;   // amplitude

  double spread(std::size_t from, std::size_t to) const {
    const auto [low, high] = std::minmax_element(depth_mm.begin() + from, depth_mm.begin() + to);
    return *high - *low;
  }
  double rms_from(std::size_t from, std::size_t to, double target_mm) const {
    double sum = 0.0;
    for (std::size_t k = from; k < to; ++k) sum += (depth_mm[k] - target_mm) * (depth_mm[k] - target_mm);
    return std::sqrt(sum / static_cast<double>(to - from));
  }
};

// What disturbs a run: a push that ends, an envelope that opens.
struct Trouble {
  double push_N = 0.0;
  double envelope_V = 8000.0;
  int until = 0;  // ticks
};

Trace driven(const std::string& model_name, double target_mm, int ticks = 12000,
             const Trouble& trouble = {}) {
  const sim::PlantModel model = sim::read_model(source_dir() / "sim" / "models" / model_name);
  Plan plan;
  plan.steps.resize(1);
  plan.steps[0].depth = Millimetres(target_mm);
  plan.steps[0].speed = MillimetresPerSecond(2.0);
  Permit permit;
  permit.hv_enable = true;
  permit.slew_up_mV_per_tick = 80'000;
  RunnerState state;
  sim::PlantState plant = sim::at_rest(model);
  Trace trace;
  for (int k = 0; k < ticks; ++k) {
    permit.v_max_mV = to_mV(Volts(k < trouble.until ? trouble.envelope_V : 8000.0));
    Measurement measurement;
    measurement.depth_um =
        static_cast<std::int32_t>(std::lround(sim::displacement_reading(model, plant) * 1e6));
    const RunnerStep result = run_steps(plan, state, measurement, permit, {});
    state = result.state;
    const double push = k < trouble.until ? trouble.push_N : 0.0;
    plant = sim::step(model, plant, {.voltage = result.request.wanted_mV * 1e-3, .external_force = push},
                      Seconds(1e-3));
    trace.depth_mm.push_back(plant.motion.x * 1e3);
    trace.drive_V.push_back(state.loop.amplitude.value);
  }
  return trace;
}

TEST(ClosedLoop, ThePapersGainsDoNotHoldTheBareBaseline) {
  const Trace trace = driven("baseline.toml", 2.5);
  // A limit cycle, not a slow decay: as wide in the last two seconds as before.
  EXPECT_GT(trace.spread(10000, 12000), 0.2);
  EXPECT_GT(trace.spread(10000, 12000), 0.8 * trace.spread(6000, 8000));
}

TEST(ClosedLoop, ThePapersGainsHoldTheRehearsalsStageWithinThePapersError) {
  for (const double target_mm : {2.0, 2.5, 3.5}) {
    const Trace trace = driven("rehearsal.toml", target_mm);
    EXPECT_LT(trace.rms_from(8000, 12000, target_mm), 0.067)
        << target_mm;  // settled RMSE of the paper's IV.F
  }
}

TEST(ClosedLoop, TenSecondsAtTheEnvelopeLeadToNoMoreOvershootThanThree) {
  // 1.95 kV do not quite reach 2.5 mm: the loop sits at its envelope until that opens.
  const auto peak = [](int until) {
    const Trace trace = driven("rehearsal.toml", 2.5, until + 8000, {.envelope_V = 1950.0, .until = until});
    EXPECT_EQ(*std::min_element(trace.drive_V.begin() + until - 500, trace.drive_V.begin() + until), 1950.0);
    EXPECT_LT(trace.rms_from(until + 5000, until + 8000, 2.5), 0.067);
    return *std::max_element(trace.depth_mm.begin() + until, trace.depth_mm.end());
  };
  EXPECT_NEAR(peak(10000), peak(3000), 0.05);
}

TEST(ClosedLoop, ASmallPushThatEndsIsRecovered) {
  const Trace trace = driven("rehearsal.toml", 2.5, 18000, {.push_N = 0.05, .until = 10000});
  EXPECT_LT(trace.rms_from(14000, 18000, 2.5), 0.067);
}

// The other half of the finding: friction holds the loop for small disturbances only. Beyond, it swings as
// the bare baseline does, and ending that is the supervisor's part.
TEST(ClosedLoop, ALargePushThatEndsSetsTheRehearsalsStageSwingingForGood) {
  const Trace trace = driven("rehearsal.toml", 2.5, 20000, {.push_N = 0.4, .until = 10000});
  EXPECT_GT(trace.spread(18000, 20000), 2.0);
}

}  // namespace
}  // namespace biopsy::control
