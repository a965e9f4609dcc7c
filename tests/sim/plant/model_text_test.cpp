// Writing models: what is written reads back as the same model, with the same notes.
#include "sim/plant/model_text.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/effects/effect_labels.hpp"
#include "sim/plant/baseline_entries.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sim/effects/staged_model.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

void expect_same(const PlantModel& a, const PlantModel& b, const std::string& text) {
  EXPECT_EQ(a.baseline.drive, b.baseline.drive) << text;
  for (const BaselineEntry& entry : baseline_entries())
    EXPECT_EQ(a.baseline.*(entry.member), b.baseline.*(entry.member)) << entry.name << "\n" << text;
  for_each_effect(a.effects, [&](const auto& slot) {
    using Slot = std::decay_t<decltype(slot)>;
    using Effect = typename Slot::value_type;
    const Slot* other = nullptr;
    for_each_effect(b.effects, [&](const auto& candidate) {
      if constexpr (std::is_same_v<std::decay_t<decltype(candidate)>, Slot>) other = &candidate;
    });
    ASSERT_EQ(slot.has_value(), other->has_value()) << Effect::info.name << "\n" << text;
    if (!slot) return;
    for (const auto& p : Effect::parameters())
      EXPECT_EQ((*slot).*(p.member), (**other).*(p.member)) << Effect::info.name << "." << p.name << "\n"
                                                            << text;
  });
}

// Models over the whole ranges: every value with all its digits, from either end, or plain.
class RandomModels {
 public:
  explicit RandomModels(std::uint32_t seed) : random_(seed) {}

  NotedModel operator()() {
    NotedModel out;
    if (chance(0.3)) out.model.baseline.drive = Drive::Force;
    if (out.model.baseline.drive == Drive::Force || chance(0.5)) out.notes.T = between(1e-5, 0.05);
    if (chance(0.5)) out.notes.title = words();
    for (const BaselineEntry& entry : baseline_entries())
      if (chance(0.7)) {
        out.model.baseline.*(entry.member) = between(entry.low, entry.high);
        note(std::string(entry.name), out.notes);
      }
    for_each_effect(out.model.effects, [&](auto& slot) {
      using Effect = typename std::decay_t<decltype(slot)>::value_type;
      if (!chance(0.5)) return;
      slot.emplace();
      for (const auto& p : Effect::parameters()) {
        (*slot).*(p.member) = between(p.low, p.high) * p.si_per_unit;
        note(fmt::format("{}.{}", Effect::info.name, p.name), out.notes);
      }
    });
    return out;
  }

  bool chance(double share) { return std::uniform_real_distribution<>(0.0, 1.0)(random_) < share; }

  double between(double low, double high) {
    if (chance(0.05)) return low;
    if (chance(0.05)) return high;
    if (low > 0.0 && chance(0.7))
      return std::min(high, low * std::pow(high / low, std::uniform_real_distribution<>(0.0, 1.0)(random_)));
    return std::uniform_real_distribution<>(low, high)(random_);
  }

 private:
  std::string words() {
    static const std::vector<std::string> pieces = {"bench", " ",  "\"", "\\", "µm", "#",    "}",
                                                    "\n",    "\t", "'",  "=",  "→",  "\x01", "\\u0041"};
    std::string out;
    for (int i = 0; i < 6; ++i) out += pieces[random_() % pieces.size()];
    return out;
  }

  void note(const std::string& key, ModelNotes& notes) {
    ValueNote made;
    if (chance(0.3)) made.std = between(0.0, 10.0);
    if (chance(0.3)) made.source = words();
    if (made != ValueNote{}) notes.values[key] = made;
  }

  std::mt19937 random_;
};

TEST(ModelText, ReadsBackAsTheSameModelAndNotes) {
  RandomModels next(1);
  for (int i = 0; i < 1000; ++i) {
    const NotedModel made = next();
    const std::string text = model_toml(made.model, made.notes);
    const NotedModel read = parse_noted_model(text, "m.toml");
    expect_same(made.model, read.model, text);
    EXPECT_EQ(made.notes, read.notes) << text;
    EXPECT_EQ(model_toml(read.model, read.notes), text);
    if (HasFailure()) return;
  }
}

TEST(ModelText, KeepsTheShippedModelsAndTheirSources) {
  for (const char* name : {"baseline.toml", "rehearsal.toml", "calibrated.toml"}) {
    const NotedModel shipped = read_noted_model(models_folder() / name);
    const std::string text = model_toml(shipped.model, shipped.notes);
    const NotedModel again = parse_noted_model(text, "m.toml");
    expect_same(shipped.model, again.model, text);
    EXPECT_EQ(shipped.notes, again.notes);
    EXPECT_EQ(shipped.model.brake, again.model.brake);
  }
  EXPECT_TRUE(read_noted_model(models_folder() / "calibrated.toml").model.brake);
}

TEST(ModelText, LeavesCorrelationsOutOnceADeviationIsGone) {
  NotedModel shipped = read_noted_model(models_folder() / "calibrated.toml");
  ASSERT_TRUE(shipped.notes.correlations);
  shipped.notes.values.at("tau").std.reset();
  const std::string text = model_toml(shipped.model, shipped.notes);
  EXPECT_FALSE(parse_noted_model(text, "m.toml").notes.correlations);
}

// What was given in people's units is written as it was typed; (7.85 * 1e-3) / 1e-3 is 7.849999999999999.
TEST(ModelText, WritesNumbersInTheirFewestDigits) {
  const NotedModel typed = parse_noted_model(
      "[baseline]\nd_film = 100e-6\n[effect.stribeck_friction]\nsliding_N = 0.05\nbreakaway_N = 0.055\n"
      "speed_mm_s = 2.3\n[effect.layer_puncture]\ndepth_mm = 7.85\nforce_N = 0.7\ndeflection_mm = 0.29\n"
      "collapse_mm = 0.57\ncutting_N = 0.011\n",
      "m.toml");
  const std::string text = model_toml(typed.model, typed.notes);
  for (const char* line : {"\nd_film = 0.0001 ", "\nn = 11 ", "\nspeed_mm_s = 2.3\n", "\ndepth_mm = 7.85\n",
                           "\ndeflection_mm = 0.29\n", "\ncollapse_mm = 0.57\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
}

TEST(ModelText, AFittedValueInOtherUnitsComesBackToTheLastBit) {
  RandomModels next(2);
  int exact = 0;
  for (int i = 0; i < 10000; ++i) {
    const double si_per_unit = (i % 2) != 0 ? 1e-3 : 1e3, high = 2.0;
    const double si = next.between(0.0, high) * si_per_unit * (1.0 - 1e-16 * (i % 3));
    const double read = std::stod(number_in_unit(si, si_per_unit, 0.0, high)) * si_per_unit;
    EXPECT_LE(std::abs(read - si), 2.3e-16 * si);
    exact += static_cast<int>(read == si);
  }
  EXPECT_GT(exact, 9000);
}

// As a fit does that knows a value by its logarithm: exp(log(high / start)) start is high but for some last
// bits, which were 0.9500000000000001 of a friction that another laboratory's servo drove to its limit.
TEST(ModelText, AValueAtALimitOfItsRangeIsWrittenAsThatLimit) {
  RandomModels next(3);
  int beyond = 0;
  for (int i = 0; i < 10000; ++i) {
    const double si_per_unit = (i % 2) != 0 ? 1e-3 : 1.0, high = std::round(next.between(1.0, 999.0)) / 20.0,
                 start = next.between(1e-3, 1.0) * high * si_per_unit;
    const double si = start * std::exp(std::log(high * si_per_unit / start));
    beyond += static_cast<int>(si / si_per_unit > high);
    const double read = std::stod(number_in_unit(si, si_per_unit, 0.0, high));
    EXPECT_LE(read, high);
    EXPECT_NEAR(read, high, 1e-12 * high);
  }
  EXPECT_GT(beyond, 1000);
}

TEST(ModelText, NamesEveryValueOfTheStack) {
  const std::string text = model_toml(PlantModel{}, ModelNotes{});
  for (const char* name : {"K", "tau", "eps_film", "d_film", "L0", "V0", "H_0", "n", "tau_h", "k", "c_k",
                           "c_s", "fixture_mass", "m_B", "C1", "T", "g"})
    EXPECT_NE(text.find("\n" + std::string(name) + " = "), std::string::npos) << name << "\n" << text;
  EXPECT_EQ(text.find("\nm = "), std::string::npos) << text;
  EXPECT_EQ(text.find("[effect"), std::string::npos) << text;
}

TEST(ModelText, OfAForceDriveNamesOnlyWhatActsThere) {
  const NotedModel rig =
      parse_noted_model("[baseline]\ndrive = \"force\"\nm = 95.1\nc_s = 203.5\nk = 0\n", "m.toml");
  EXPECT_FALSE(rig.notes.T);
  const std::string text = model_toml(rig.model, rig.notes);
  for (const char* line : {"drive = \"force\"", "\nm = 95.1 ", "\nc_s = 203.5 ", "\nk = 0 "})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  for (const char* name : {"K", "tau", "n", "c_k", "m_B", "C1", "fixture_mass", "T", "g"})
    EXPECT_EQ(text.find("\n" + std::string(name) + " = "), std::string::npos) << name << "\n" << text;
}

TEST(ModelText, AChangeLeavesTheSourcesOfEverythingElse) {
  NotedModel model = read_noted_model(models_folder() / "rehearsal.toml");
  const ModelNotes before = model.notes;
  ASSERT_EQ(before.values.size(), 6U);
  model.model.baseline.K = 0.86;
  model.notes.values["K"] = {0.002, "runs of 2024-05-02"};
  model.model.effects.coulomb_friction.emplace().force = 0.021;
  model.notes.values["coulomb_friction.force_N"] = {0.001, "runs of 2024-05-02"};
  const std::string text = model_toml(model.model, model.notes);
  EXPECT_NE(text.find("\nK = { value = 0.86, std = 0.002, source = \"runs of 2024-05-02\" }"),
            std::string::npos);
  EXPECT_NE(text.find("\nforce_N = { value = 0.021, std = 0.001, source = \"runs of 2024-05-02\" }\n"),
            std::string::npos)
      << text;
  const NotedModel after = parse_noted_model(text, "m.toml");
  for (const auto& [key, note] : before.values) EXPECT_EQ(after.notes.values.at(key), note) << key;
  EXPECT_EQ(after.notes.values.size(), before.values.size() + 2);
  EXPECT_EQ(after.notes.title, before.title);
}

TEST(ModelText, RefusesAModelThatCouldNotBeReadBack) {
  PlantModel model;
  const auto refused = [&](const ModelNotes& notes = {}) {
    return refusal([&] { model_toml(model, notes); });
  };
  model.baseline.k = -3.0;
  expect_refusal(refused(), "the model to be written", "`k` = -3 is outside");
  model.baseline.k = std::nan("");
  expect_refusal(refused(), "the model to be written", "`k` is not a finite number");
  model = {};
  model.effects.sensor_noise.emplace().std = 1.0;  // m
  expect_refusal(refused(), "the model to be written", "`std_mm` = 1000 is outside");
  model = {};
  ModelNotes notes;
  notes.values["kk"] = {0.1, ""};
  expect_refusal(refused(notes), "the model to be written", "`kk`");
  notes.values = {{"coulomb_friction.force_N", {0.1, ""}}};  // absent
  expect_refusal(refused(notes), "the model to be written", "coulomb_friction.force_N");
  notes.values = {{"k", {-0.1, ""}}};
  expect_refusal(refused(notes), "the model to be written", "`std`");
}

TEST(ModelFile, RefusesAnUnknownNameBesideAValue) {
  expect_refusal(refusal([] { parse_model("[baseline]\n\nk = { value = 140, sdt = 3 }\n", "m.toml"); }),
                 "m.toml:3: ", "unknown name `sdt`");
  expect_refusal(refusal([] { parse_model("[baseline]\nk = { value = 140, std = -3 }\n", "m.toml"); }),
                 "m.toml:2: ", "`std` = -3 is outside");
  expect_refusal(refusal([] { parse_model("[baseline]\nk = { value = 140, source = 3 }\n", "m.toml"); }),
                 "m.toml:2: ", "`source` is not a text");
}

TEST(BaselineEntries, HoldTheReferenceAndPlainMechanics) {
  for (const BaselineEntry& entry : baseline_entries()) {
    const double value = Baseline{}.*(entry.member);
    EXPECT_TRUE(entry.low <= value && value <= entry.high) << entry.name;
    EXPECT_FALSE(entry.meaning.empty()) << entry.name;
    EXPECT_TRUE(entry.stack || entry.force) << entry.name;
    EXPECT_EQ(baseline_entry(entry.name), &entry);
  }
  EXPECT_EQ(baseline_entry("kk"), nullptr);
  const PlantModel rig =
      parse_model("[baseline]\ndrive = \"force\"\nm = 1e4\nc_s = 1e6\nk = 1e9\n", "m.toml");
  EXPECT_EQ(rig.baseline.k, 1e9);
}

TEST(Units, AreReadOffTheNames) {
  EXPECT_EQ(unit_of("force_N"), "N");
  EXPECT_EQ(unit_of("speed_mm_s"), "mm/s");
  EXPECT_EQ(unit_of("coulomb_N_per_mm"), "N/mm");
  EXPECT_EQ(unit_of("viscous_N_s_per_m_per_mm"), "N s/m per mm");
  EXPECT_EQ(unit_of("drag_N_s2_per_m2"), "N s^2/m^2");
  EXPECT_EQ(unit_of("time_ms"), "ms");
  EXPECT_EQ(unit_of("gain"), "");
  EXPECT_EQ(unit_of("s"), "");  // a name, not seconds
}

}  // namespace
}  // namespace biopsy::sim
