// The stage's configuration file: accepted, refused, and mutated at random.
#include "drivers/nidaqmx/config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "drivers/nidaqmx/daqmx_functions.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sim/plant/refusal.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::nidaqmx {
namespace {

const std::string kSampleFile = source_dir() / "drivers/nidaqmx/usb6211.toml";

std::string sample() {
  return file_content(kSampleFile);
}

std::string with(const std::string& old, const std::string& replacement) {
  std::string text = sample();
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), replacement);
}

std::string refusal_of_text(const std::string& text) {
  return sim::refusal([&] { parse_config(text, "stage.toml"); });
}

TEST(NidaqmxConfig, SampleIsAccepted) {
  const Config config = read_config(kSampleFile);
  EXPECT_EQ(config.device, "Dev1");
  EXPECT_EQ(config.laser.input.terminal, kRse);
  EXPECT_EQ(config.voltage.input.terminal, kDiff);
  EXPECT_EQ(config.laser.mm_per_V, 2.0);
  EXPECT_EQ(config.command.highest_kV, 8.0);
  EXPECT_EQ(config.interlock.enable_line, 1U);
  ASSERT_TRUE(config.panel);
  EXPECT_EQ(config.panel->estop_b_line, 3U);
  ASSERT_TRUE(config.relay_contact);
  EXPECT_EQ(config.relay_contact->input.number, 4U);
  EXPECT_EQ(config.relay_contact->closed_V, 2.5);
}

TEST(NidaqmxConfig, EveryWrongEntryIsNamedWithItsLineAndARemedy) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {with("device = \"Dev1\"", "device = \"Dev1/ai0\""), "is not one device"},
      {with("closed_V = 2.5", "closed_V = 0"), "counts an open wire as closed"},
      {with("closed_V = 2.5", "closed_V = 11"), "outside [0, 10]"},
      {with("channel = \"ai4\"", "channel = \"ai9\""), "ai9 connected twice"},
      {with("timeout_ms = 2.0", "timeout_ms = 2000"), "outside [0.1, 20]"},
      {with("channel = \"ai0\"", "channel = \"ai16\""), "is none of ai0 to ai15"},
      {with("channel = \"ai0\"", "channel = \"ai9\""), "ai9 connected twice"},
      {with("channel = \"ai1\"", "channel = \"ai9\""), "no partner for Diff"},
      {with("channel = \"ai1\"", "channel = \"ai\""), "is none of"},
      {with("terminal = \"RSE\"", "terminal = \"NRSE\""), "neither RSE nor Diff"},
      {with("mm_per_V = 2.0", "mm_per_V = 0.001"), "is zero"},
      {with("mm_per_V = 2.0", "mm_per_V = 1.0"), "outside what counts as valid"},
      {with("zero_V = 1.5", "zero_V = nan"), "not a finite number"},
      {with("zero_V = 1.5", "zero_V = \"1.5\""), "not a finite number"},
      {with("zero_V = 1.5", "zero = 1.5"), "`zero_V` is missing"},
      {with("kV_per_V = 1.0 ", "kV_per_V = 0.5 "), "cannot show 8.2 kV"},
      {with("mA_per_V = 4.0", "mA_per_V = 0.1"), "cannot show 2 mA"},
      {with("highest_kV = 8.0", "highest_kV = 9.0"), "outside [0.1, 8]"},
      {with("enable = \"line1\"", "enable = \"line0\""), "the line of the pulse"},
      {with("# brake = \"line2\"", "brake = \"line1\""), "the line of another output"},
      {with("# brake = \"line2\"", "brake = \"line0\""), "the line of another output"},
      {with("# brake = \"line2\"", "brake = \"line4\""), "is none of line0 to line3"},
      {with("port = \"port0\"", "port = \"port1\""), "port of the interlock"},
      {with("estop_b = \"line3\"", "estop_b = \"line2\""), "is used twice"},
      {with("estop_b = \"line3\"", "estop_c = \"line3\""), "`estop_b` is missing"},
      {with("low_V = 0.0", "low_V = 10.0"), "is not above"},
      {with("[laser]", "[lasers]"), "`laser` is missing"},
      {sample() + "\n[extra]\n", "unknown name `extra`"},
      {with("[laser]", "[[laser]]"), "not a table"},
      {with("\"Dev2\"", "\"Dev1\""), "the stage's board"},
      {"", "`device` is missing"},
      {"device = ", "stage.toml:1"},
  };
  for (const auto& [text, words] : wrong) {
    sim::expect_refusal(refusal_of_text(text), "stage.toml:", words);
  }
}

TEST(NidaqmxConfig, MissingFileIsRefused) {
  EXPECT_NE(sim::refusal([] { read_config("/nowhere/stage.toml"); }).find("usb6211.toml"), std::string::npos);
  EXPECT_NE(sim::refusal([] { read_config("/"); }), "accepted");
}

bool is_within(double value, double low, double high) {
  return std::isfinite(value) && value >= low && value <= high;
}

void expect_in_range(const Config& config) {
  EXPECT_TRUE(is_within(config.timeout_s, 1e-4, 0.02));
  for (const AnalogInput* input : {&config.laser.input, &config.voltage.input, &config.current.input}) {
    EXPECT_LE(input->number, 15U);
    EXPECT_TRUE(input->terminal == kRse || input->terminal == kDiff);
    EXPECT_TRUE(is_within(input->low_V, -10.0, 10.0) && is_within(input->high_V, -10.0, 10.0));
    EXPECT_LT(input->low_V, input->high_V);
  }
  EXPECT_TRUE(is_within(std::abs(config.laser.mm_per_V), 0.01, 100.0));
  EXPECT_TRUE(is_within(config.laser.zero_V, config.laser.input.low_V, config.laser.input.high_V));
  EXPECT_GE(config.voltage.per_V * config.voltage.input.high_V, 8.2 * (1 - 1e-12));
  EXPECT_GE(config.current.per_V * config.current.input.high_V, 2.0 * (1 - 1e-12));
  EXPECT_TRUE(is_within(config.command.highest_kV, 0.1, 8.0));
  EXPECT_LE(config.command.highest_kV / config.command.kV_per_V, 10.0);
  EXPECT_TRUE(config.interlock.pulse_line <= 3 &&
              config.interlock.enable_line != config.interlock.pulse_line);
  EXPECT_FALSE(config.device.empty());
}

// Bytes changed, removed and inserted, and values exchanged.
std::string mutated(std::mt19937_64& random, std::string text) {
  const std::vector<std::string> words{
      "-1", "1e308",     "nan", "inf", "-inf",        "0x10", "\"\"",       "\"ai15\"", "\"line9\"", "[",
      "]",  "[[laser]]", "=",   "\n",  "\"\\u0000\"", "true", "1979-05-27", "{",        "'"};
  const std::size_t times = 1 + random() % 4;
  for (std::size_t k = 0; k < times && !text.empty(); ++k) {
    const std::size_t at = random() % text.size();
    const std::size_t length = random() % std::min<std::size_t>(40, text.size() - at + 1);
    switch (random() % 4) {
      case 0:
        text[at] = static_cast<char>(random() % 256);
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, words[random() % words.size()]);
        break;
      default: {  // the value of an entry
        const std::size_t equals = text.find("= ", at);
        if (equals == std::string::npos) break;
        const std::size_t end = text.find_first_of(" \n", equals + 2);
        text.replace(equals + 2, end - equals - 2, words[random() % words.size()]);
      }
    }
  }
  return text;
}

TEST(NidaqmxConfig, MutatedFileIsRefusedOrInRange) {
  std::mt19937_64 random(20261121);
  const std::string text = sample();
  int accepted = 0, refused = 0;
  for (int k = 0; k < 8'000; ++k) {
    try {
      expect_in_range(parse_config(mutated(random, text), "stage.toml"));
      ++accepted;
    } catch (const ConfigError& error) {
      EXPECT_FALSE(error.what_is_wrong.empty() || error.remedy.empty());
      ++refused;
    }
  }
  EXPECT_GT(accepted, 200);
  EXPECT_GT(refused, 2'000);
}

}  // namespace
}  // namespace biopsy::nidaqmx
