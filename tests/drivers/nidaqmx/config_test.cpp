// The stage's configuration file: accepted, refused, and mutated at random.
#include "drivers/nidaqmx/config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <tuple>
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

// Reported: one entry read for another passed all tests, because the sample's entries are alike. Here each is
// a number of its own.
TEST(NidaqmxConfig, EveryEntryIsItsOwnField) {
  const Config config = parse_config(R"(
library = "/opt/ni.so"
device = "Left"
serial = 4711
timeout_ms = 3.5
laser = {channel = "ai5", terminal = "Diff", low_V = -1.5, high_V = 9.5, zero_V = 1.25, mm_per_V = 2.5, valid_low_V = 0.5, valid_high_V = 8.75}
second_laser = {channel = "ai6", terminal = "RSE", low_V = -2.5, high_V = 8.5, zero_V = 1.75, mm_per_V = 3.5, valid_low_V = 0.75, valid_high_V = 7.75}
voltage_monitor = {channel = "ai1", terminal = "RSE", low_V = -9.0, high_V = 9.25, kV_per_V = 1.5}
current_monitor = {channel = "ai2", terminal = "RSE", low_V = -7.0, high_V = 7.25, mA_per_V = 0.625}
command = {channel = "ao1", kV_per_V = 2.0, highest_kV = 6.5}
interlock = {port = "port1", pulse = "line3", enable = "line0", brake = "line2"}
panel = {port = "port0", arm_key = "line2", reset_key = "line0", estop_a = "line3", estop_b = "line1"}
relay_contact = {channel = "ai7", terminal = "RSE", low_V = 0.25, high_V = 6.25, closed_V = 3.75}
supervisor_pulse = {device = "Right", port = "port7", pulse = "line19"}
)",
                                     "stage.toml");
  const auto input = [](const AnalogInput& of) {
    return std::tuple(of.number, of.terminal, of.low_V, of.high_V);
  };
  const auto laser = [](const Laser& of) {
    return std::tuple(of.zero_V, of.mm_per_V, of.valid_low_V, of.valid_high_V);
  };
  EXPECT_EQ(config.library, "/opt/ni.so");
  EXPECT_EQ(config.device, "Left");
  EXPECT_EQ(config.serial, 4711U);
  EXPECT_DOUBLE_EQ(config.timeout_s, 0.0035);
  EXPECT_EQ(input(config.laser.input), std::tuple(5U, kDiff, -1.5, 9.5));
  EXPECT_EQ(laser(config.laser), std::tuple(1.25, 2.5, 0.5, 8.75));
  ASSERT_TRUE(config.second_laser && config.panel && config.relay_contact && config.supervisor_pulse);
  EXPECT_EQ(input(config.second_laser->input), std::tuple(6U, kRse, -2.5, 8.5));
  EXPECT_EQ(laser(*config.second_laser), std::tuple(1.75, 3.5, 0.75, 7.75));
  EXPECT_EQ(input(config.voltage.input), std::tuple(1U, kRse, -9.0, 9.25));
  EXPECT_EQ(config.voltage.per_V, 1.5);
  EXPECT_EQ(input(config.current.input), std::tuple(2U, kRse, -7.0, 7.25));
  EXPECT_EQ(config.current.per_V, 0.625);
  EXPECT_EQ(std::tuple(config.command.number, config.command.kV_per_V, config.command.highest_kV),
            std::tuple(1U, 2.0, 6.5));
  const Interlock& lines = config.interlock;
  EXPECT_EQ(std::tuple(lines.port, lines.pulse_line, *lines.enable_line, *lines.brake_line),
            std::tuple(1U, 3U, 0U, 2U));
  const PanelInputs& panel = *config.panel;
  EXPECT_EQ(std::tuple(panel.port, panel.arm_line, panel.reset_line, panel.estop_a_line, panel.estop_b_line),
            std::tuple(0U, 2U, 0U, 3U, 1U));
  EXPECT_EQ(input(config.relay_contact->input), std::tuple(7U, kRse, 0.25, 6.25));
  EXPECT_EQ(config.relay_contact->closed_V, 3.75);
  EXPECT_EQ(config.supervisor_pulse->device, "Right");
  EXPECT_EQ(std::pair(config.supervisor_pulse->port, config.supervisor_pulse->line), std::pair(7U, 19U));
  EXPECT_EQ(analog_inputs(config).size(), 5U);
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

// The last value that is accepted and the first that is not, of each number: from the board's data sheet (16
// inputs, 2 outputs, 2 ports of 4 lines, 10 V) and from the limits that the entries' comments state.
TEST(NidaqmxConfig, EveryNumberEndsWhereItShould) {
  struct Edge {
    const char* entry;
    std::vector<const char*> accepted;
    std::vector<std::pair<const char*, const char*>> refused;
  };
  const std::vector<Edge> edges{
      {"timeout_ms = 2.0",
       {"timeout_ms = 0.1", "timeout_ms = 20.0"},
       {{"timeout_ms = 0.09", "[0.1, 20]"}, {"timeout_ms = 20.1", "[0.1, 20]"}}},
      {"device = \"Dev1\"", {}, {{"device = \"\"", "is not a name"}}},
      {"channel = \"ai0\"", {"channel = \"ai15\""}, {{"channel = \"ai16\"", "none of ai0 to ai15"}}},
      {"channel = \"ai1\"", {"channel = \"ai7\""}, {{"channel = \"ai8\"", "no partner for Diff"}}},
      {"channel = \"ao0\"", {"channel = \"ao1\""}, {{"channel = \"ao2\"", "none of ao0 to ao1"}}},
      {"port = \"port1\"\npulse = \"line0\"",
       {},
       {{"port = \"port2\"\npulse = \"line0\"", "none of port0 to port1"},
        {"port = \"port1\"\npulse = \"line4\"", "none of line0 to line3"}}},
      {"\"Dev2\"\nport = \"port0\"\npulse = \"line0\"",
       {"\"Dev2\"\nport = \"port15\"\npulse = \"line31\""},
       {{"\"Dev2\"\nport = \"port16\"\npulse = \"line0\"", "none of port0 to port15"},
        {"\"Dev2\"\nport = \"port0\"\npulse = \"line32\"", "none of line0 to line31"}}},
      {"low_V = 0.0", {}, {{"low_V = 11.0", "[-10, 10]"}, {"low_V = -10.1", "[-10, 10]"}}},
      {"high_V = 10.0", {}, {{"high_V = -5.0", "is not above"}, {"high_V = 10.1", "[-10, 10]"}}},
      {"mm_per_V = 2.0",
       {"mm_per_V = 100.0", "mm_per_V = -100.0"},
       {{"mm_per_V = 100.1", "[-100, 100]"},
        {"mm_per_V = -100.1", "[-100, 100]"},
        {"mm_per_V = 0.0101", "outside what counts as valid"},
        {"mm_per_V = 0.0099", "is zero"},
        {"mm_per_V = -0.0099", "is zero"}}},
      // The stroke of 12 mm, 2 mm beyond it and 1 mm before rest, at 2 mm/V and 1.5 V: 1.0 to 8.5 V.
      {"valid_low_V = 0.2",
       {"valid_low_V = 1.0"},
       {{"valid_low_V = 1.001", "at -1 mm, 1.00 V"}, {"valid_low_V = -0.1", "[0, 10]"}}},
      {"valid_high_V = 9.8", {"valid_high_V = 8.5"}, {{"valid_high_V = 8.499", "at 14 mm, 8.50 V"}}},
      {"high_V = 10.0\nkV_per_V = 1.0 ",
       {"high_V = 8.2\nkV_per_V = 1.0 ", "high_V = 10.0\nkV_per_V = 100.0 "},
       {{"high_V = 8.1\nkV_per_V = 1.0 ", "cannot show 8.2 kV"},
        {"high_V = 10.0\nkV_per_V = 0.0101 ", "cannot show 8.2 kV"},
        {"high_V = 10.0\nkV_per_V = 0.0099 ", "[0.01, 100]"},
        {"high_V = 10.0\nkV_per_V = 100.1 ", "[0.01, 100]"}}},
      {"low_V = -10.0\nhigh_V = 10.0\nmA_per_V = 4.0",
       {"low_V = -0.5\nhigh_V = 10.0\nmA_per_V = 4.0"},
       {{"low_V = -0.49\nhigh_V = 10.0\nmA_per_V = 4.0", "cannot show 2 mA"},
        {"low_V = -10.0\nhigh_V = 0.49\nmA_per_V = 4.0", "cannot show 2 mA"}}},
      {"kV_per_V = 1.0            # Trek 10/40: 1 V for 1 kV\nhighest_kV = 8.0",
       {"kV_per_V = 0.8\nhighest_kV = 8.0", "kV_per_V = 0.1\nhighest_kV = 1.0",
        "kV_per_V = 10.0\nhighest_kV = 0.1"},
       {{"kV_per_V = 0.79\nhighest_kV = 8.0", "needs more than the board's 10 V"},
        {"kV_per_V = 0.5\nhighest_kV = 8.0", "needs more than the board's 10 V"},
        {"kV_per_V = 0.099\nhighest_kV = 0.5", "[0.1, 10]"},
        {"kV_per_V = 10.1\nhighest_kV = 8.0", "[0.1, 10]"},
        {"kV_per_V = 1.0\nhighest_kV = 0.099", "[0.1, 8]"}}},
      {"estop_a = \"line2\"", {}, {{"estop_a = \"line0\"", "used twice"}}},
      {"channel = \"ai4\"", {"channel = \"ai11\""}, {{"channel = \"ai3\"", "ai3 connected twice"}}},
      {"closed_V = 2.5", {"closed_V = 0.5"}, {{"closed_V = 0.0", "counts an open wire as closed"}}},
      {"high_V = 10.0\nclosed_V = 2.5", {}, {{"high_V = 2.0\nclosed_V = 2.5", "[0, 2]"}}},
      {"low_V = 0.0\nhigh_V = 10.0\nclosed_V = 2.5",
       {},
       {{"low_V = -5.0\nhigh_V = 10.0\nclosed_V = -1.0", "counts an open wire as closed"}}},
  };
  for (const Edge& edge : edges) {
    for (const char* accepted : edge.accepted)
      EXPECT_EQ(refusal_of_text(with(edge.entry, accepted)), "accepted") << accepted;
    for (const auto& [refused, words] : edge.refused)
      sim::expect_refusal(refusal_of_text(with(edge.entry, refused)), "stage.toml:", words);
  }
}

TEST(NidaqmxConfig, ANameHasAtMost255LettersAndThePortsMayBeEitherWayRound) {
  EXPECT_EQ(refusal_of_text(with("\"Dev1\"", "\"" + std::string(255, 'D') + "\"")), "accepted");
  sim::expect_refusal(refusal_of_text(with("\"Dev1\"", "\"" + std::string(256, 'D') + "\"")),
                      "stage.toml:", "is not a name");
  sim::expect_refusal(refusal_of_text(with("\"Dev1\"", "\"" + std::string(300, 'D') + "\"")),
                      "stage.toml:", "is not a name");
  std::string exchanged = with("port = \"port1\"", "port = \"portX\"");
  exchanged.replace(exchanged.find("\"port0\""), 7, "\"port1\"");
  exchanged.replace(exchanged.find("portX"), 5, "port0");
  EXPECT_EQ(refusal_of_text(exchanged), "accepted");
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
