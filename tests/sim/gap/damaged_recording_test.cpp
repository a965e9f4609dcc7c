// Recordings that were damaged on purpose: each is named by its cause, and never by an effect. The recordings
// are of two generators that share no code with sim/: the stage of generator/, the rig of recordings/.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "sim/gap/examine/examine.hpp"
#include "sim/gap/find_gap.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_data.hpp"
#include "tests/sim/gap/recordings/rig.hpp"

namespace biopsy::hidden {
namespace {

using sim::Dataset;
using sim::RecordedRun;

constexpr double kNoise = 10e-6;  // m

struct Bench {
  Dataset data;
  sim::PlantModel model;
};

// A stage with small calibration errors, some friction, three short runs.
const Bench& stage() {
  static const Bench bench = [] {
    HiddenCase one;
    one.name = "stage";
    one.kind = HiddenKind::Single;
    one.terms = {{"coulomb_friction", 0.02}};
    one.seed = 4711;
    one.length = 0.35;
    one.runs = 3;
    one.plate_b = true;
    return Bench{make_hidden(one), sim::parse_model(baseline_model(one), "model.toml")};
  }();
  return bench;
}

const Bench& rig() {
  static const Bench bench{rig_recording({.damping_ratio = 0.13, .grip = 0.05}, kNoise, 7),
                           sim::parse_model(rig_model({}), "rig.toml")};
  return bench;
}

struct Damage {
  std::string name, cause;
  std::function<void(Dataset&)> apply;
  bool stage = true, rig = true;
};

std::function<void(Dataset&)> each(std::function<void(RecordedRun&)> change) {
  return [change](Dataset& data) {
    for (RecordedRun& run : data.runs) change(run);
  };
}

std::function<void(Dataset&)> one(std::function<void(RecordedRun&)> change) {
  return [change](Dataset& data) { change(data.runs.back()); };
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

void delay(std::vector<double>& values, long rows) {
  std::vector<double> out(values.size(), values.front());
  for (long i = 0; i < static_cast<long>(values.size()); ++i)
    out[static_cast<std::size_t>(i)] =
        values[static_cast<std::size_t>(std::clamp(i - rows, 0L, static_cast<long>(values.size()) - 1))];
  values = out;
}

void swap_input(RecordedRun& run) {  // as numbers of a file
  for (std::size_t i = 0; i < run.input.size(); ++i) {
    const double volts = run.input[i];
    run.input[i] = run.displacement[i] * 1e3;
    run.displacement[i] = volts * 1e-3;
  }
}

std::vector<Damage> damages() {
  return {
      {"metres", "unit", each([](RecordedRun& r) { scale(r.displacement, 1e-3); })},
      {"micrometres", "unit", each([](RecordedRun& r) { scale(r.displacement, 1e3); })},
      {"centimetres", "unit", each([](RecordedRun& r) { scale(r.displacement, 0.1); })},
      {"inches", "unit", each([](RecordedRun& r) { scale(r.displacement, 1.0 / 25.4); })},
      {"grams of force", "unit", each([](RecordedRun& r) { scale(r.input, 1.0 / 9.80665e-3); }), false},
      {"kilo input", "unit", each([](RecordedRun& r) { scale(r.input, 1e-3); })},
      {"milli input", "unit", each([](RecordedRun& r) { scale(r.input, 1e3); })},
      {"metres in one run", "unit", one([](RecordedRun& r) { scale(r.displacement, 1e-3); })},
      {"kilo input in one run", "unit", one([](RecordedRun& r) { scale(r.input, 1e-3); })},
      {"sign", "sign", each([](RecordedRun& r) { scale(r.displacement, -1.0); })},
      {"sign of one run", "sign", one([](RecordedRun& r) { scale(r.displacement, -1.0); })},
      {"sign of the force", "sign", each([](RecordedRun& r) { scale(r.input, -1.0); }), false},
      {"columns exchanged", "swapped", each(swap_input)},
      {"columns exchanged in one run", "swapped", one(swap_input)},
      {"files exchanged", "swapped",
       [](Dataset& d) { std::swap(d.runs.front().displacement, d.runs.back().displacement); }},
      {"dead", "constant", each([](RecordedRun& r) { std::ranges::fill(r.displacement, 0.0); })},
      {"dead in one run", "constant", one([](RecordedRun& r) { std::ranges::fill(r.displacement, 1e-3); })},
      {"input not recorded", "constant", each([](RecordedRun& r) { std::ranges::fill(r.input, 0.0); })},
      {"frozen", "frozen", one([](RecordedRun& r) {
         const std::size_t n = r.displacement.size();
         for (std::size_t i = n * 45 / 100; i < n * 62 / 100; ++i)
           r.displacement[i] = r.displacement[n * 45 / 100];
       })},
      {"dead from the middle on", "frozen", one([](RecordedRun& r) {
         const std::size_t n = r.displacement.size();
         for (std::size_t i = n / 2; i < n; ++i) r.displacement[i] = r.displacement[n / 2];
       })},
      {"falls to its lower end and stays", "frozen", one([](RecordedRun& r) {
         const auto [low, high] = std::ranges::minmax(r.displacement);
         for (std::size_t i = r.displacement.size() * 3 / 5; i < r.displacement.size(); ++i)
           r.displacement[i] = low - 0.5 * (high - low);
       })},
      {"falls far below its range and stays", "frozen", one([](RecordedRun& r) {
         for (std::size_t i = r.displacement.size() * 3 / 4; i < r.displacement.size(); ++i)
           r.displacement[i] = -0.5;
       })},
      {"clipped", "clipped", each([](RecordedRun& r) {
         const double limit = 0.6 * std::ranges::max(r.displacement);
         for (double& x : r.displacement) x = std::min(x, limit);
       })},
      {"outliers", "outliers", one([](RecordedRun& r) {
         for (std::size_t i = 101; i < r.displacement.size(); i += 397) r.displacement[i] += 20e-3;
       })},
      {"marks of missing readings", "missing", each([](RecordedRun& r) {
         for (std::size_t i = 40; i < r.displacement.size(); i += 89) r.displacement[i] = 9.999;
       })},
      {"a stretch of marks", "missing", one([](RecordedRun& r) {
         for (std::size_t i = 300; i < 345; ++i) r.displacement[i] = -1.0;
       })},
      {"copied run", "copied", [](Dataset& d) { d.runs.back().displacement = d.runs.front().displacement; }},
      {"ten times too fast", "unit", each([](RecordedRun& r) { scale(r.time, 0.1), r.period *= 0.1; })},
      {"ten times too slow", "unit", each([](RecordedRun& r) { scale(r.time, 10.0), r.period *= 10.0; }),
       false},
      {"reading before its cause", "time_offset",
       each([](RecordedRun& r) { delay(r.displacement, -static_cast<long>(0.15 / r.period)); })},
      {"reading half a second late", "time_offset",
       each([](RecordedRun& r) { delay(r.displacement, static_cast<long>(0.5 / r.period)); })},
      {"noise in micrometres", "unit", [](Dataset& d) { d.sensor_noise = *d.sensor_noise * 1e3; }},
      {"weight in kilograms", "unit", each([](RecordedRun& r) { r.weight *= 1e-3; }), true, false}};
}

std::vector<DataRemark> examined(const Bench& bench, const Damage* damage) {
  Dataset data = bench.data;
  if (damage != nullptr) damage->apply(data);
  return sim::gap::examine(data, bench.model, sim::gap::noise_of(data));
}

std::string listed(const std::vector<DataRemark>& remarks) {
  std::string out;
  for (const DataRemark& one : remarks)
    out += fmt::format("{}{}: {}\n", one.cause, one.blocks ? "" : " (only a remark)", one.sentence);
  return out;
}

void expect_named(const Bench& bench, const Damage& damage) {
  const std::vector<DataRemark> remarks = examined(bench, &damage);
  SCOPED_TRACE(damage.name + "\n" + listed(remarks));
  const bool blocked = !remarks.empty() && remarks.front().blocks;
  EXPECT_TRUE(blocked);
  if (blocked) {
    EXPECT_EQ(remarks.front().cause, damage.cause);
  }
}

TEST(DamagedRecording, OfTheStageIsNamedByItsCause) {
  for (const Damage& damage : damages())
    if (damage.stage && damage.name != "files exchanged") expect_named(stage(), damage);
}

TEST(DamagedRecording, OfARigIsNamedByItsCause) {
  for (const Damage& damage : damages())
    if (damage.rig) expect_named(rig(), damage);
}

// To a linear mechanism kilonewtons for newtons and millimetres for micrometres are the same: one is said, of
// all runs.
TEST(DamagedRecording, AUnitIsTheSameInAllRuns) {
  for (const Damage& damage : damages()) {
    if (damage.cause != "unit" || !damage.rig || damage.name.find("one run") != std::string::npos) continue;
    if (damage.name.starts_with("noise") || damage.name.starts_with("ten times")) continue;
    const std::vector<DataRemark> remarks = examined(rig(), &damage);
    const auto units = std::ranges::count_if(remarks, [](const DataRemark& one) {
      return one.cause == "unit" && one.channel != "sensor_noise_mm";
    });
    EXPECT_EQ(units, 1) << damage.name << "\n" << listed(remarks);
  }
}

// The file is right, and the numbers of the model are a guess: a mechanism that a force drives moves the same
// way.
TEST(DamagedRecording, AGuessedModelIsNamedBesideTheUnitOrClockThatItResembles) {
  for (const double factor : {25.0, 1.0 / 1000.0}) {
    Bench bench = rig();
    for (double* number : {&bench.model.baseline.m, &bench.model.baseline.c_s, &bench.model.baseline.k})
      *number /= factor;
    const std::vector<DataRemark> remarks = examined(bench, nullptr);
    ASSERT_EQ(remarks.size(), 1U) << listed(remarks);
    EXPECT_NE(remarks[0].sentence.find("If the file is right, m, c_s and k of the model are"),
              std::string::npos)
        << remarks[0].sentence;
    EXPECT_NE(remarks[0].sentence.find(factor > 1.0 ? " 25.4 times too small" : " 1000 times too large"),
              std::string::npos);
  }
  Bench quick = rig();
  quick.model.baseline.m *= 0.01;
  quick.model.baseline.c_s *= 0.1;
  const std::vector<DataRemark> remarks = examined(quick, nullptr);
  ASSERT_EQ(remarks.size(), 1U) << listed(remarks);
  EXPECT_NE(remarks[0].sentence.find("m of the model is 100 times too small and c_s 10 times too small"),
            std::string::npos)
      << remarks[0].sentence;
}

TEST(DamagedRecording, NumbersThatAreNotKnownAreNotHeldAgainstTheFile) {
  for (const double factor : {25.0, 0.1}) {
    Bench bench = rig();
    for (double* number : {&bench.model.baseline.m, &bench.model.baseline.c_s, &bench.model.baseline.k})
      *number /= factor;
    sim::gap::SearchOptions told;
    told.free = {"m", "c_s", "k"};
    const GapFinding finding = sim::gap::find_gap(bench.data, bench.model, told).finding;
    EXPECT_EQ(listed(finding.data), "") << factor;
    EXPECT_EQ(finding.verdict, GapVerdict::Effect) << factor;  // the rig's dry friction
  }
}

// But what other numbers cannot explain is: a sign, exchanged columns, one run in another unit.
TEST(DamagedRecording, NumbersThatAreNotKnownHideNoOtherDamage) {
  sim::gap::SearchOptions told;
  told.free = {"m", "c_s", "k"};
  for (const char* name : {"sign", "metres in one run", "columns exchanged in one run"}) {
    Bench bench = rig();
    const std::vector<Damage> all = damages();
    const auto damage = std::ranges::find(all, std::string(name), &Damage::name);
    ASSERT_NE(damage, all.end()) << name;
    damage->apply(bench.data);
    const GapFinding finding = sim::gap::find_gap(bench.data, bench.model, told).finding;
    ASSERT_FALSE(finding.data.empty()) << name;
    EXPECT_EQ(finding.data.front().cause, damage->cause) << listed(finding.data);
    EXPECT_TRUE(finding.data.front().blocks) << name;
  }
}

TEST(DamagedRecording, UndamagedNothingIsFound) {
  for (const Bench* bench : {&stage(), &rig()}) EXPECT_EQ(listed(examined(*bench, nullptr)), "");
}

TEST(DamagedRecording, AQuantisedOneIsRemarkedAndItsNoiseRaised) {
  Bench bench = rig();
  for (RecordedRun& run : bench.data.runs)
    for (double& x : run.displacement) x = std::round(x / 1e-4) * 1e-4;
  const auto remarks = examined(bench, nullptr);
  ASSERT_EQ(remarks.size(), 1U) << listed(remarks);
  EXPECT_EQ(remarks[0].cause, "quantised");
  EXPECT_NEAR(sim::gap::noise_of(bench.data), 1e-4 / std::sqrt(12.0), 1e-9);
}

// On one step of a coarse sensor the error repeats: it tells nothing of how friction begins.
TEST(DamagedRecording, ACoarseOneOfDryFrictionHasNoFinerName) {
  for (const double steps : {12.0, 18.0, 26.0}) {
    Dataset data = rig_recording({.hertz = 0.9, .damping_ratio = 0.15, .grip = 0.3}, kNoise, 23);
    double range = 0.0;
    for (const RecordedRun& run : data.runs) range = std::max(range, sim::gap::range_of(run.displacement));
    for (RecordedRun& run : data.runs)
      for (double& x : run.displacement) x = std::round(x * steps / range) * range / steps;
    const GapFinding finding =
        sim::gap::find_gap(data,
                           sim::parse_model(rig_model({.hertz = 0.9, .damping_ratio = 0.15}), "rig.toml"), {})
            .finding;
    for (const FoundEffect& one : finding.effects) EXPECT_EQ(one.name, "coulomb_friction") << steps;
  }
}

TEST(DamagedRecording, ASlowlySampledResonanceIsRemarked) {
  Bench bench = rig();
  bench.model.baseline.k *= 1e4;
  bench.model.baseline.c_s *= 1e2;
  EXPECT_NE(listed(examined(bench, nullptr)).find("sampling (only a remark)"), std::string::npos);
}

TEST(DamagedRecording, RepeatedRunsThatDisagreeAreNamed) {
  Bench bench = rig();
  bench.data.runs[2] = bench.data.runs[0];
  bench.data.runs[2].name = "again";
  for (double& x : bench.data.runs[2].displacement) x = 0.7 * x + 3e-3;
  const auto remarks = examined(bench, nullptr);
  ASSERT_FALSE(remarks.empty());
  EXPECT_EQ(remarks[0].cause, "repeats_differ") << listed(remarks);
}

// A motor that friction holds throughout one run reads the same in every row if its encoder has steps: driven
// as hard as in the runs in which it moves, it would not.
TEST(DamagedRecording, ARunThatFrictionHoldsIsNoDeadSensor) {
  const auto with_last_run_still = [](double driven, double step) {
    Bench bench = rig();
    for (RecordedRun& run : bench.data.runs)
      for (double& x : run.displacement) x = step > 0.0 ? std::round(x / step) * step : x;
    RecordedRun& last = bench.data.runs.back();
    scale(last.input, driven);
    std::ranges::fill(last.displacement, 0.0);
    return examined(bench, nullptr);
  };
  const auto is_dead = [](const DataRemark& one) { return one.cause == "constant" && one.blocks; };
  const std::vector<DataRemark> held = with_last_run_still(0.1, 1e-3);
  EXPECT_TRUE(std::ranges::none_of(held, is_dead)) << listed(held);
  EXPECT_NE(listed(held).find("friction may hold it"), std::string::npos) << listed(held);
  for (const auto& [driven, step] : {std::pair{1.0, 1e-3}, {0.1, 0.0}}) {
    const std::vector<DataRemark> dead = with_last_run_still(driven, step);
    EXPECT_TRUE(std::ranges::any_of(dead, is_dead)) << listed(dead);
  }
}

TEST(DamagedRecording, ADeadSensorIsNamedUnderAConstantInputToo) {
  Bench bench = rig();
  for (RecordedRun& run : bench.data.runs) {
    std::ranges::fill(run.input, 1.5);
    std::ranges::fill(run.displacement, 2e-3);
  }
  const std::vector<DataRemark> remarks = examined(bench, nullptr);
  ASSERT_FALSE(remarks.empty());
  EXPECT_TRUE(remarks[0].blocks) << listed(remarks);
}

// What is as well explained by one reading of the file as by another is not said to be one of them alone.
TEST(DamagedRecording, NamesWhatElseExplainsIt) {
  Bench bench = rig();
  for (RecordedRun& run : bench.data.runs) scale(run.displacement, 1e-3);  // metres, or an input in mN
  const std::vector<DataRemark> remarks = examined(bench, nullptr);
  ASSERT_FALSE(remarks.empty());
  EXPECT_NE(remarks[0].sentence.find("displacement_mm is in m and not in mm"), std::string::npos)
      << remarks[0].sentence;
  EXPECT_NE(remarks[0].sentence.find("force_N is in mN and not in N"), std::string::npos)
      << remarks[0].sentence;
}

TEST(DamagedRecording, IsNotSearchedAndKeepsTheModel) {
  Dataset data = rig().data;
  for (RecordedRun& run : data.runs) std::ranges::fill(run.displacement, 0.0);
  const auto found = sim::gap::find_gap(data, rig().model, {});
  EXPECT_EQ(found.finding.verdict, GapVerdict::Unexplained);
  EXPECT_TRUE(found.finding.effects.empty());
  EXPECT_TRUE(found.finding.candidates.empty());
  ASSERT_FALSE(found.finding.data.empty());
  EXPECT_EQ(found.finding.data[0].cause, "constant");
}

// A heavy filter of the reading delays it as well: an effect of the sensor, and no clock.
TEST(DamagedRecording, AHeavilyFilteredReadingHasNoWrongClock) {
  const Rig heavy{.hertz = 0.4, .damping_ratio = 0.6};
  for (const double time : {0.25, 0.4, 0.8}) {
    Dataset data = rig_recording(heavy, 0.0, 29);
    Dice dice(31);
    for (RecordedRun& run : data.runs) {
      double y = 0.0;
      for (double& x : run.displacement) x = (y += (x - y) * run.period / time) + kNoise * dice.normal();
    }
    data.sensor_noise = kNoise;
    const GapFinding finding =
        sim::gap::find_gap(data, sim::parse_model(rig_model(heavy), "rig.toml"), {}).finding;
    EXPECT_TRUE(finding.data.empty()) << time << "\n" << listed(finding.data);
    ASSERT_EQ(finding.effects.size(), 1U) << time;
    EXPECT_EQ(finding.effects[0].name, "sensor_lag");
    EXPECT_NEAR(finding.effects[0].parameters[0].value, 1e3 * time, 0.05e3 * time);
  }
}

}  // namespace
}  // namespace biopsy::hidden
