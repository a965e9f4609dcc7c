// The step that checks the loop rate, on ticks with given delays.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "drivers/commissioning/sample_figures.hpp"
#include "tests/robot/bench/commissioning_benches.hpp"

namespace biopsy::commissioning {
namespace {

// Ticks of 300 us, on time, but for what `disturb` does to them.
class TimedRig final : public Rig {
 public:
  explicit TimedRig(std::function<void(int, Sample&)> disturb) : disturb_(std::move(disturb)) {}

  Sample rest() override {
    Sample sample;
    sample.reading.time_us = 1'000 * ++tick_;
    sample.work_us = 300;
    disturb_(tick_, sample);
    return sample;
  }
  Drive drive(std::int32_t, std::uint32_t, const std::function<bool(const Sample&)>&) override { return {}; }
  void feed_interlock(bool) override {}
  void feed_supervisors_half(bool) override {}

 private:
  std::function<void(int, Sample&)> disturb_;
  int tick_ = 0;
};

std::string wrong_with(const std::function<void(int, Sample&)>& disturb) {
  TimedRig rig(disturb);
  SilentOperator operator_;
  for (const Step& step : all_steps()) {
    if (step.name != "loop rate") continue;
    const Measured measured = step.measure(rig, operator_);
    for (std::size_t k = 0; k < step.limits.size(); ++k)
      if (!(measured.values[k] >= step.limits[k].low && measured.values[k] <= step.limits[k].high))
        return std::string(step.limits[k].what);
  }
  return "nothing";
}

TEST(LoopRate, SteadyTicksPass) {
  EXPECT_EQ(wrong_with([](int, Sample&) {}), "nothing");
}

TEST(LoopRate, FewSpreadOutMissesPass) {
  EXPECT_EQ(wrong_with([](int tick, Sample& s) { s.late_us = tick % 1'100 == 0 ? 900 : 0; }), "nothing");
}

TEST(LoopRate, BoardThatIsTooSlowIsRefused) {
  EXPECT_EQ(wrong_with([](int, Sample& s) { s.work_us = 1'100; }), "ticks that missed their millisecond");
  EXPECT_EQ(wrong_with([](int, Sample& s) { s.work_us = 900; }), "work of a tick, 99 of 100");
}

// So many misses, this far apart.
auto misses(int count, int apart) {
  return [=](int tick, Sample& s) {
    const int since = tick - 5'000;
    s.late_us = since >= 0 && since < count * apart && since % apart == 0 ? 900 : 0;
  };
}

TEST(LoopRate, ThirdMissWithinAHundredMillisecondsIsRefused) {
  EXPECT_EQ(wrong_with(misses(2, 30)), "nothing");
  EXPECT_EQ(wrong_with(misses(3, 30)), "most of them within 100 ms");
  EXPECT_EQ(wrong_with(misses(9, 51)), "nothing");
}

TEST(LoopRate, GapThatIsAClockJumpForTheSupervisorIsRefused) {
  EXPECT_EQ(wrong_with([](int tick, Sample& s) { s.reading.time_us += tick > 5'000 ? 4'500 : 0; }),
            "longest time between two readings");
  EXPECT_EQ(wrong_with([](int, Sample& s) { s.reading.time_us = 7; }), "longest time between two readings")
      << "a clock that stands still";
}

TEST(SampleFigures, LineThroughItsOwnPointsIsFound) {
  const Line line = line_through({-2.0, 0.0, 1.0, 3.0}, {-3.9, 0.1, 2.1, 6.1});
  EXPECT_NEAR(line.gain, 2.0, 1e-12);
  EXPECT_NEAR(line.offset, 0.1, 1e-12);
  EXPECT_NEAR(line.largest_residual, 0.0, 1e-12);
}

}  // namespace
}  // namespace biopsy::commissioning
