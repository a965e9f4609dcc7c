// Faults of a file: what is read, what is refused, and what the stage then shows. Inputs: text written for
// this test, and the calibrated stage under a constant 4 kV.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "robot/common/config_error.hpp"
#include "robot/common/files/data_folder.hpp"
#include "sim/faults/fault_file.hpp"
#include "sim/faults/faulty_stage.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim {
namespace {

Fault parsed(const std::string& entries) {
  return parse_faults("[[fault]]\n" + entries, "faults.toml").at(0);
}

TEST(FaultFile, ReadsEveryEntry) {
  const Fault fault = parsed(
      "signal = \"depth\"\nkind = \"drift\"\nfrom_depth_mm = 1.5\nfrom_s = 2\nuntil_s = 3\nvalue = "
      "-0.1\nnoise = 0.01\non_ms = 7\noff_ms = 4\n");
  EXPECT_EQ(fault.on_ms, 7);
  EXPECT_EQ(fault.off_ms, 4);
  EXPECT_EQ(fault.signal, FaultSignal::Depth);
  EXPECT_EQ(fault.kind, FaultKind::Drift);
  EXPECT_EQ(fault.from_depth_mm, 1.5);
  EXPECT_EQ(fault.from_s, 2.0);
  EXPECT_EQ(fault.until_s, 3.0);
  EXPECT_EQ(fault.value, -0.1);
  EXPECT_EQ(fault.noise, 0.01);
}

TEST(FaultFile, RefusesWhatItCannotMean) {
  for (const char* text : {"", "[[fault]]\n", "[[fault]]\nsignal = \"laser\"\nkind = \"frozen\"\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"stuck\"\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"offset\"\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"offset\"\nvalue = 500\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"offset\"\nvalue = nan\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"lag\"\nvalue = 0\n",
                           "[[fault]]\nsignal = \"permit\"\nkind = \"scale\"\nvalue = 2\n",
                           "[[fault]]\nsignal = \"drive\"\nkind = \"other_surface\"\nvalue = 2\n",
                           "[[fault]]\nsignal = \"brake\"\nkind = \"offset\"\nvalue = 1\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"frozen\"\nfrom_s = 3\nuntil_s = 2\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"frozen\"\non_ms = 3\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"frozen\"\non_ms = 3\noff_ms = 0\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"command\"\n",
                           "[[fault]]\nsignal = \"depth\"\nkind = \"frozen\"\nfrom = 3\n", "fault = 3\n"})
    EXPECT_THROW(parse_faults(text, "faults.toml"), ConfigError) << text;
}

TEST(FaultFile, RefusesWhatWouldChangeNothing) {
  for (const char* text :
       {"signal = \"depth\"\nkind = \"noise\"\n", "signal = \"depth\"\nkind = \"noise\"\nvalue = 0.2\n",
        "signal = \"drive\"\nkind = \"missing_polarity\"\nvalue = 0\n",
        "signal = \"relay\"\nkind = \"frozen\"\nnoise = 0.1\n",
        "signal = \"permit\"\nkind = \"frozen\"\nnoise = 0.1\n",
        "signal = \"arm_key\"\nkind = \"other_surface\"\nvalue = 0.5\n"})
    EXPECT_THROW(parse_faults("[[fault]]\n" + std::string(text), "faults.toml"), ConfigError) << text;
  EXPECT_EQ(parsed("signal = \"arm_key\"\nkind = \"other_surface\"\nvalue = 1\n").value, 1.0);
}

TEST(FaultFile, SaysTheRangeInTheUnitOfTheKind) {
  const auto told = [](const std::string& text) -> std::string {
    try {
      parse_faults("[[fault]]\nsignal = \"depth\"\n" + text, "faults.toml");
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "not refused";
  };
  EXPECT_EQ(told("kind = \"dropout\"\nvalue = 1.5\n").find("mm"), std::string::npos);
  EXPECT_EQ(told("kind = \"scale\"\nvalue = 20\n").find("mm"), std::string::npos);
  EXPECT_NE(told("kind = \"drift\"\nvalue = 200\n").find("mm/s"), std::string::npos);
  EXPECT_NE(told("kind = \"offset\"\nvalue = 200\n").find("mm"), std::string::npos);
  EXPECT_NE(told("kind = \"lag\"\nvalue = 2000\n").find("ms"), std::string::npos);
}

SimulatedStage calibrated_stage() {
  PlantModel model = read_model(source_dir() / "sim/models/calibrated.toml");
  return {model, 1};
}

// The last of `ticks` readings under 4 kV, and the sound stage's own at that moment.
struct Shown {
  drivers::SensorReading seen;
  double true_mm;
};
Shown after(std::vector<Fault> faults, int ticks) {
  SimulatedStage sound = calibrated_stage();
  FaultyStage faulty(sound, std::move(faults), 1);
  drivers::SensorReading seen;
  for (int k = 0; k < ticks; ++k) {
    seen = faulty.read();
    sound.put_out(k % 500 < 250 ? 4500.0 : -4500.0);
  }
  return {seen, sound.truth().motion.x * 1e3};
}

TEST(FaultyStage, WithoutFaultsIsTheStage) {
  SimulatedStage sound = calibrated_stage();
  for (int k = 0; k < 1999; ++k) sound.read(), sound.put_out(k % 500 < 250 ? 4500.0 : -4500.0);
  EXPECT_EQ(after({}, 2000).seen.depth_um, sound.read().depth_um);
}

TEST(FaultyStage, ShowsWhatTheKindSays) {
  const Shown sound = after({}, 2000);
  ASSERT_GT(sound.true_mm, 0.5);  // it moves, or nothing below means anything
  const double depth_um = sound.seen.depth_um;
  const auto depth = [&](FaultKind kind, double value) {
    return after({{.signal = FaultSignal::Depth, .kind = kind, .value = value}}, 2000).seen.depth_um;
  };
  EXPECT_NEAR(depth(FaultKind::Offset, -1.0), depth_um - 1000.0, 1.0);
  EXPECT_NEAR(depth(FaultKind::Scale, 0.5), depth_um * 0.5, 1.0);
  EXPECT_NEAR(depth(FaultKind::Drift, 2.0), depth_um + 3998.0, 1.0);
  EXPECT_EQ(depth(FaultKind::Inverted, 0.0), -depth_um);
  EXPECT_EQ(depth(FaultKind::OtherSurface, 7.0), 7000);
  EXPECT_EQ(depth(FaultKind::Quantised, 0.5) % 500, 0);
  EXPECT_NEAR(depth(FaultKind::Lag, 200.0), after({}, 1800).seen.depth_um, 1.0);
  EXPECT_LT(depth(FaultKind::Frozen, 0.0), 100);  // from the first reading on
  EXPECT_FALSE(
      after({{.signal = FaultSignal::Depth, .kind = FaultKind::Dropout, .value = 1.0}}, 10).seen.laser_valid);
}

// Of each of 40 ticks: whether another surface, which is not there, is shown.
std::string surface_shown(std::int32_t on_ms, std::int32_t off_ms) {
  SimulatedStage sound = calibrated_stage();
  FaultyStage faulty(sound,
                     {{.kind = FaultKind::OtherSurface, .value = 7.0, .on_ms = on_ms, .off_ms = off_ms}}, 1);
  std::string shown;
  for (int k = 0; k < 20; ++k) {
    shown += faulty.read().depth_um == 7'000 ? '#' : '.';
    EXPECT_EQ(faulty.active_faults(), 1U) << "it has begun, whether it shows or not";
    sound.put_out(0.0);
  }
  return shown;
}

TEST(FaultyStage, AnIntermittentFaultShowsByTurns) {
  EXPECT_EQ(surface_shown(0, 0), "####################");
  EXPECT_EQ(surface_shown(3, 2), "###..###..###..###..");
  EXPECT_EQ(surface_shown(1, 4), "#....#....#....#....");
}

TEST(FaultyStage, AnIntermittentFreezeStaysEachTimeWhereItBegan) {
  std::set<std::int32_t> shown_um;
  SimulatedStage sound = calibrated_stage();
  FaultyStage faulty(sound, {{.kind = FaultKind::Frozen, .on_ms = 200, .off_ms = 1}}, 1);
  for (int k = 0; k < 2'000; ++k) {
    shown_um.insert(faulty.read().depth_um);
    sound.put_out(k % 500 < 250 ? 4500.0 : -4500.0);
  }
  EXPECT_GE(shown_um.size(), 10U);
  EXPECT_LE(shown_um.size(), 20U) << "of two thousand readings";
}

// The driver asks for 4 kV, a weak amplifier puts out half of it.
TEST(FaultyStage, AMonitorOfTheCommandShowsWhatWasAsked) {
  SimulatedStage sound = calibrated_stage();
  FaultyStage faulty(sound,
                     {{.signal = FaultSignal::VoltageMonitor, .kind = FaultKind::Command},
                      {.signal = FaultSignal::Drive, .kind = FaultKind::Scale, .value = 0.5}},
                     1);
  safety::GateState gate;
  Permit permit{.session = 1, .epoch = 1, .ttl_us = 5'000, .mode = Mode::Safe};
  DriveRequest request{.wanted_mV = 4'000'000};
  for (int k = 0; k < 100; ++k) {
    faulty.read();
    ++permit.seq, ++request.seq;
    const safety::GateResult result = safety::gate(gate, &request, &permit, 1'000 * (k + 1), 1);
    gate = result.state;
    faulty.write(result.voltage);
    permit.mode = Mode::Active, permit.stop = StopCategory::None, permit.hv_enable = true;
    permit.v_max_mV = 8'000'000, permit.slew_up_mV_per_tick = 400'000;
  }
  EXPECT_EQ(faulty.read().monitor_mV, 4'000'000);
  EXPECT_NEAR(sound.truth().u_i, 2'000.0, 100.0);
}

// A needle that is lifted, locked, and left without voltage: how far it has moved half a second later. mm
double moved_mm(const std::vector<Fault>& faults) {
  SimulatedStage sound = calibrated_stage();
  FaultyStage faulty(sound, faults, 1);
  safety::GateState gate;
  Permit permit{
      .session = 1, .epoch = 1, .ttl_us = 5'000, .v_max_mV = 8'000'000, .slew_up_mV_per_tick = 400'000};
  DriveRequest request;
  double before_mm = 0.0;
  for (int k = 0; k < 2'600; ++k) {
    faulty.read();
    ++permit.seq, ++request.seq;
    permit.hv_enable = permit.brake = k > 0;  // the first permit of a session is off
    permit.mode = k > 0 ? Mode::Active : Mode::Safe;
    permit.stop = k > 0 ? StopCategory::None : StopCategory::C0Off;
    request.brake = k > 2'000;
    request.wanted_mV = k > 2'100 ? 0 : k % 500 < 250 ? 4'500'000 : -4'500'000;
    const safety::GateResult result = safety::gate(gate, &request, &permit, 1'000 * (k + 1), 1);
    gate = result.state;
    faulty.write(result.voltage);
    if (k == 2'100) before_mm = sound.truth().motion.x * 1e3;
  }
  return sound.truth().motion.x * 1e3 - before_mm;
}

TEST(FaultyStage, ABrakeHoldsTheNeedleAndAFaultyOneDoesNot) {
  EXPECT_NEAR(moved_mm({}), 0.0, 0.1);
  using enum FaultKind;
  for (const Fault& fault : {Fault{.signal = FaultSignal::Brake, .kind = Frozen},
                             Fault{.signal = FaultSignal::Brake, .kind = Scale, .value = 0.0},
                             Fault{.signal = FaultSignal::Brake, .kind = Scale, .value = 0.02},
                             Fault{.signal = FaultSignal::Brake, .kind = Dropout, .value = 1.0},
                             Fault{.signal = FaultSignal::Brake, .kind = Lag, .value = 1000.0}})
    EXPECT_LT(moved_mm({fault}), -0.3) << name_of(fault.kind) << fault.value;
  EXPECT_NEAR(moved_mm({Fault{.signal = FaultSignal::Brake, .kind = Scale, .value = 0.5}}), 0.0, 0.1);
}

TEST(FaultyStage, BeginsAtItsDepth) {
  const Fault frozen{.kind = FaultKind::Frozen, .from_depth_mm = 0.4};
  const Shown shown = after({frozen}, 2000);
  EXPECT_NEAR(shown.seen.depth_um, 400.0, 150.0);
  EXPECT_GT(shown.true_mm, 0.6);
}

}  // namespace
}  // namespace biopsy::sim
