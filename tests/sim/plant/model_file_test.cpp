// Model files: what is shipped, what is accepted, and what is refused with file, line and reason.
#include "sim/plant/model_file.hpp"

#include <gtest/gtest.h>

#include "robot/common/files/file.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sim/effects/staged_model.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

void expect_reference_values(const Baseline& b) {  // docs/explanation/model.md, section 1
  EXPECT_EQ(b.drive, Drive::Stack);
  EXPECT_EQ(b.K, 0.80);
  EXPECT_EQ(b.tau, 6.9);
  EXPECT_EQ(b.eps_film, 3.4);
  EXPECT_EQ(b.d_film, 100e-6);
  EXPECT_EQ(b.L0, 0.060);
  EXPECT_EQ(b.V0, 1.9e-7);
  EXPECT_EQ(b.H_0, 0.35e-3);
  EXPECT_EQ(b.n, 11);
  EXPECT_EQ(b.tau_h, 0.030);
  EXPECT_EQ(b.k, 140);
  EXPECT_EQ(b.c_k, 0.05);
  EXPECT_EQ(b.c_s, 0.60);
  EXPECT_EQ(b.fixture_mass, 0.030);
  EXPECT_EQ(b.m_B, 0.030);
  EXPECT_EQ(b.C1, 2.0e-9);
  EXPECT_EQ(b.g, 9.81);
}

int effects_in(const PlantModel& model) {
  int count = 0;
  for_each_effect(model.effects, [&](const auto& slot) { count += slot.has_value(); });
  return count;
}

TEST(BaselineFile, HoldsExactlyTheReferenceValuesAndNoEffect) {
  const PlantModel model = read_model(models_folder() / "baseline.toml");
  expect_reference_values(model.baseline);
  EXPECT_EQ(effects_in(model), 0);
  const std::string text = read_file(models_folder() / "baseline.toml");
  EXPECT_NE(text.find("\nT = 1e-3"), std::string::npos);  // the control period is the build's own
  EXPECT_EQ(kTick, std::chrono::milliseconds(1));
}

TEST(BaselineFile,
     NamesEveryValueItself) {  // so that the defaults of the program cannot stand in for a lost line
  const std::string text = read_file(models_folder() / "baseline.toml");
  for (const std::string name : {"K", "tau", "eps_film", "d_film", "L0", "V0", "H_0", "n", "tau_h", "k",
                                 "c_k", "c_s", "fixture_mass", "m_B", "C1", "T", "g"})
    EXPECT_NE(text.find("\n" + name + " = "), std::string::npos) << name;
}

TEST(BaselineDefaults, AreTheReferenceValues) {
  expect_reference_values(Baseline{});
}

TEST(RehearsalFile, IsTheBaselineWithFourEffects) {
  const PlantModel model = read_model(models_folder() / "rehearsal.toml");
  expect_reference_values(model.baseline);
  EXPECT_EQ(effects_in(model), 4);
  ASSERT_TRUE(model.effects.stribeck_friction && model.effects.sensor_noise);
  EXPECT_DOUBLE_EQ(model.effects.stribeck_friction->speed, 2e-3);  // mm/s in the file
  EXPECT_DOUBLE_EQ(model.effects.sensor_noise->std, 10e-6);
}

TEST(ModelFile, TakesANumberOrAValueWithItsDeviationAndSource) {
  const PlantModel model = parse_model(
      "title = \"x\"\n[baseline]\nk = { value = 150, std = 4, source = \"bench\" }\nn = 9\n"
      "[effect.coulomb_friction]\nforce_N = { value = 0.03 }\n",
      "m.toml");
  EXPECT_EQ(model.baseline.k, 150);
  EXPECT_EQ(model.baseline.n, 9);
  EXPECT_EQ(model.effects.coulomb_friction->force, 0.03);
}

TEST(ModelFile, DriveForceNeedsNothingOfTheStack) {
  const PlantModel model =
      parse_model("[baseline]\ndrive = \"force\"\nm = 0.5\nc_s = 2\nk = 300\n", "m.toml");
  EXPECT_EQ(model.baseline.drive, Drive::Force);
  EXPECT_EQ(model.mass_A(), 0.5);
}

struct Refused {
  const char* name;
  const char* text;
  const char* place;
  const char* reason;
};

class ModelFileRefuses : public testing::TestWithParam<Refused> {};

TEST_P(ModelFileRefuses, NamingFileLineAndReason) {
  expect_refusal(refusal([] { parse_model(GetParam().text, "m.toml"); }), GetParam().place,
                 GetParam().reason);
}

INSTANTIATE_TEST_SUITE_P(
    Files, ModelFileRefuses,
    testing::Values(
        Refused{"UnknownBaselineName", "[baseline]\nK = 0.8\nkk = 1\n", "m.toml:3: ", "unknown name `kk`"},
        Refused{"BrakeWithoutItsForce", "[baseline]\n[brake]\nstiffness_N_per_mm = 20\n",
                "m.toml:2: ", "`holding_N` is missing"},
        Refused{
            "BrakeOfNoForce",
            "[baseline]\n[brake]\nholding_N = 0\nstiffness_N_per_mm = 20\ndamping_N_s_per_m = 1\nengage_ms = "
            "1\nrelease_ms = 1\n",
            "m.toml:3: ", "outside [0.1, 1000]"},
        Refused{"UnknownEffect", "[baseline]\n\n[effect.magic]\nx = 1\n",
                "m.toml:3: ", "unknown name `magic`"},
        Refused{"UnknownParameter", "[baseline]\n[effect.coulomb_friction]\nforce_N = 0.1\nmu = 0.2\n",
                "m.toml:4: ", "unknown name `mu`"},
        Refused{"ParameterInAnotherUnit", "[baseline]\n[effect.coulomb_friction]\nforce_mN = 50\n",
                "m.toml:2: ", "`force_N` is missing"},
        Refused{"UnknownTable", "[baseline]\n[baselime]\n", "m.toml:2: ", "unknown name `baselime`"},
        Refused{"NoBaseline", "title = \"x\"\n", "m.toml:", "`baseline` is missing"},
        Refused{"Empty", "", "m.toml:", "`baseline` is missing"},
        Refused{"MissingParameter",
                "[baseline]\n[effect.stribeck_friction]\nsliding_N = 0.1\nbreakaway_N = 0.2\n",
                "m.toml:2: ", "`speed_mm_s` is missing"},
        Refused{"TooLarge", "[baseline]\nK = 0.8\nk = 1e10\n", "m.toml:3: ", "`k` = 10000000000 is outside"},
        Refused{"Negative", "[baseline]\nfixture_mass = -0.03\n", "m.toml:2: ", "is outside"},
        Refused{"ZeroTime", "[baseline]\ntau = 0\n", "m.toml:2: ", "is outside"},
        Refused{"EffectOutOfRange", "[baseline]\n[effect.sensor_noise]\nstd_mm = 10\n",
                "m.toml:3: ", "is outside"},
        Refused{"NotANumber", "[baseline]\nk = nan\n", "m.toml:2: ", "`k` is not a finite number"},
        Refused{"Infinite", "[baseline]\nk = inf\n", "m.toml:2: ", "`k` is not a finite number"},
        Refused{"MinusInfinite", "[baseline]\nk = { value = -inf }\n",
                "m.toml:2: ", "`k` is not a finite number"},
        Refused{"Text", "[baseline]\nk = \"140\"\n", "m.toml:2: ", "`k` is not a finite number"},
        Refused{"Flag", "[baseline]\nk = true\n", "m.toml:2: ", "`k` is not a finite number"},
        Refused{"List", "[baseline]\nk = [140]\n", "m.toml:2: ", "`k` is not a finite number"},
        Refused{"TableWithoutValue", "[baseline]\nk = { std = 3 }\n",
                "m.toml:2: ", "`k` is a table without `value`"},
        Refused{"BaselineIsANumber", "baseline = 3\n", "m.toml:1: ", "`baseline` is not a table"},
        Refused{"EffectIsANumber", "[baseline]\n[effect]\ncoulomb_friction = 0.1\n",
                "m.toml:3: ", "is not a table"},
        Refused{"DriveOfAnotherKind", "[baseline]\ndrive = \"magnet\"\n", "m.toml:", "`drive`"},
        Refused{"DriveIsANumber", "[baseline]\ndrive = 1\n", "m.toml:2: ", "`drive` is not a text"},
        Refused{"CorrelationOfAValueWithoutDeviation",
                "[baseline]\nk = 140\n[correlation]\nvalues = [\"k\"]\nlower = []\n", "m.toml:4",
                "`k` has no deviation"},
        Refused{
            "CorrelationOfTheSameTwice",
            "[baseline]\nk = { value = 140, std = 3 }\n[correlation]\nvalues = [\"k\", \"k\"]\nlower = [1]\n",
            "m.toml:4", "stands twice"},
        Refused{"CorrelationsTooFew",
                "[baseline]\nk = { value = 140, std = 3 }\ntau = { value = 7, std = 1 }\n[correlation]\n"
                "values = [\"k\", \"tau\"]\nlower = []\n",
                "m.toml:6", "0 numbers for 2 values"},
        Refused{"CorrelationBeyondOne",
                "[baseline]\nk = { value = 140, std = 3 }\ntau = { value = 7, std = 1 }\n[correlation]\n"
                "values = [\"k\", \"tau\"]\nlower = [1.5]\n",
                "m.toml:6", "outside"},
        Refused{"NoToml", "[baseline]\nk = = 3\n", "m.toml:2: ", ""},
        Refused{"TwiceTheSame", "[baseline]\nk = 1\nk = 2\n", "m.toml:3: ", ""}),
    [](const auto& given) { return given.param.name; });

TEST(ModelFile, ThatIsNotThereIsRefusedByItsName) {
  expect_refusal(refusal([] { read_model("/nowhere/model.toml"); }),
                 "/nowhere/model.toml: ", "cannot be read");
  const ScratchFolder folder;
  expect_refusal(refusal([&] { read_model(folder.path()); }), folder.path().string(), "cannot be read");
}

TEST(TissueFile, RefusesWhatItCannotUse) {
  const ScratchFolder folder;
  folder.write("none.toml", "[tissue.muscle]\n");
  expect_refusal(refusal([&] { read_tissues(folder.path() / "none.toml"); }),
                 (folder.path() / "none.toml:1").string(), "is missing");
  const std::string text = read_file(models_folder() / "tissues.toml");
  const auto unknown = text.find("[tissue.unknown]");
  ASSERT_NE(unknown, std::string::npos);
  folder.write("known.toml", text.substr(0, unknown));
  expect_refusal(refusal([&] { read_tissues(folder.path() / "known.toml"); }),
                 (folder.path() / "known.toml").string(), "[tissue.unknown]");
}

TEST(Tissue, RefusesAPathOfMoreLayersThanThePlantHolds) {
  const auto table = read_tissues(models_folder() / "tissues.toml");
  std::vector<Layer> layers;
  for (int i = 0; i < static_cast<int>(kMaxLayers) + 1; ++i)
    layers.push_back({"muscle", Millimetres(i), Millimetres(i + 1)});
  EXPECT_THROW(tissue_along(layers, table), ConfigError);
  layers.pop_back();
  EXPECT_EQ(tissue_along(layers, table).size(), kMaxLayers);
}

}  // namespace
}  // namespace biopsy::sim
