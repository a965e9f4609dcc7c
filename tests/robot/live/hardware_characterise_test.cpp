// `biopsy characterise` on the laboratory's stage in real time: a hand turns the key and lays weights on.
#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "robot/bench/characterise.hpp"
#include "sim/plant/dataset.hpp"
#include "tests/robot/live/laboratory.hpp"
#include "tests/robot/live/steady_host.hpp"

namespace biopsy::live_tests {
namespace {

using Clock = std::chrono::steady_clock;
using DoubleSeconds = std::chrono::duration<double>;

struct Laid {
  double after_first_volt_s, grams;
};

// Asked for 7, 13, 19 and 25 s after the first volt; a second later each.
constexpr std::array kLaid{Laid{8.0, 1.0}, Laid{14.0, 2.0}, Laid{20.0, 1.0}, Laid{26.0, 0.0}};

// Turns the arm key, again where it was turned before it was asked for, then lays multiples of `weight_N` on
// at those moments.
void lay_on(const std::stop_token& stop, fake::Board& board, double weight_N) {
  const auto wait_until = [&](const auto& so) {
    while (!stop.stop_requested() && !so()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  const auto has_volts = [&] { return board.output_V != 0.0; };
  while (!stop.stop_requested() && !has_volts()) {
    board.contacts &= ~1U;
    const auto turned = Clock::now() + std::chrono::seconds(8), given_up = turned + std::chrono::seconds(12);
    wait_until([&] { return Clock::now() > turned; });
    board.contacts |= 1U;
    wait_until([&] { return has_volts() || Clock::now() > given_up; });
  }
  const auto first_volt = Clock::now();
  for (const Laid& laid : kLaid) {
    wait_until([&] { return DoubleSeconds(Clock::now() - first_volt).count() > laid.after_first_volt_s; });
    board.push_N = laid.grams * weight_N;
  }
}

struct Change {
  double after_first_volt_s, force_N;
};

std::vector<Change> changes_of(const sim::RecordedRun& run) {
  std::vector<Change> changes;
  std::size_t first_volt = 0;
  while (run.input[first_volt] == 0.0) ++first_volt;
  for (std::size_t row = 1; row < run.time.size(); ++row)
    if (run.external_force[row] != run.external_force[row - 1])
      changes.push_back({run.time[row] - run.time[first_volt], run.external_force[row]});
  return changes;
}

TEST(HardwareLive, CharacteriseAsksAHandForWeightsAndDatesThemByTheDepth) {
  const Lab lab;
  lab.commission();
  constexpr double kSixGrams_N = 6 * 9.81e-3;
  const fs::path leaky = lab.folder.path() / "leaky.toml";  // rests for 3.5 s
  std::ofstream(leaky) << "[baseline]\ntau = 0.5\n";
  const robot::CharacteriseOptions options{.experiments = {"load"},
                                           .device = "nidaqmx",
                                           .model = leaky,
                                           .bench = true,
                                           .weights_by_hand = true,
                                           .device_config = lab.hardware.config,
                                           .commissioning = lab.hardware.commissioning,
                                           .keys = lab.options.keys,
                                           .out = lab.folder.path() / "data"};
  const bool here = on_a_steady_host([&]() -> std::string {
    fake::Board& board = *fake_reset();
    const std::jthread hand([&](const std::stop_token& stop) { lay_on(stop, board, kSixGrams_N); });
    const robot::Characterisation made =
        robot::characterise(options, {}, {}, [](const std::string& text) { std::puts(text.c_str()); });
    return made.complete ? "" : made.text;
  });
  if (!here) return;
  const sim::Dataset data = sim::read_dataset(options.out, sim::Drive::Stack);
  ASSERT_EQ(data.runs.size(), 1U);
  const std::vector<Change> changes = changes_of(data.runs.front());
  ASSERT_EQ(changes.size(), kLaid.size());
  for (std::size_t i = 0; i < kLaid.size(); ++i) {
    EXPECT_NEAR(changes[i].after_first_volt_s, kLaid[i].after_first_volt_s, 0.1);
    EXPECT_NEAR(changes[i].force_N, kLaid[i].grams * kSixGrams_N, 1e-6);
  }
  const std::string report = file_content(options.out / "report.html");
  EXPECT_NE(report.find("laid on by hand"), std::string::npos);
  EXPECT_EQ(report.find("does not show"), std::string::npos);
  EXPECT_EQ(report.find("was lent"), std::string::npos) << "noise is the model's affair";
  EXPECT_NE(file_content(options.out / "run-load-50g.csv").find("# weights were laid on by hand"),
            std::string::npos);
}

}  // namespace
}  // namespace biopsy::live_tests
