// A stage on the bench, from the first volt to the name of what its model is missing.
#include <cmath>
#include <numeric>
#include <regex>

#include "sim/plant/dataset.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/simulate.hpp"
#include "tests/robot/cli/command.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoise = "[effect.sensor_noise]\nstd_mm = 0.010\n";
constexpr const char* kFriction = "[effect.coulomb_friction]\nforce_N = 0.050\n";

double rms_mm(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 1e3 * std::sqrt(sum / static_cast<double>(a.size()));
}

sim::Dataset stored(const fs::path& folder) {
  return sim::read_dataset(folder, sim::Drive::Stack);
}

// gap.json of the data set in data/ and the model assumed.toml.
nlohmann::json effect_found(const ScratchFolder& folder) {
  const Outcome answer =
      biopsy("gap " + (folder / "data").string() + " --model " + (folder / "assumed.toml").string() +
             " --out " + (folder / "gap").string() + " --no-recheck");
  if (answer.code != 0) throw std::runtime_error(answer.text);
  nlohmann::json found = json_of(folder / "gap/gap.json");
  if (found["verdict"] != "effect") throw std::runtime_error(answer.text);
  return found;
}

TEST(Characterise, NamesTheFrictionThatWasHiddenInTheStage) {
  const ScratchFolder folder;
  folder.write("stage.toml", std::string("[baseline]\n") + kNoise + kFriction);
  folder.write("assumed.toml", std::string("[baseline]\n") + kNoise);
  const Outcome measured = biopsy("characterise staircase dc --bench --model " +
                                  (folder / "stage.toml").string() + " --out " + (folder / "data").string());
  ASSERT_EQ(measured.code, 0) << measured.text;
  const nlohmann::json found = effect_found(folder);
  ASSERT_EQ(found["effects"].size(), 1U);
  EXPECT_EQ(found["effects"][0]["name"], "coulomb_friction");
  EXPECT_NEAR(found["effects"][0]["parameters"]["force_N"]["value"], 0.050, 0.002);
  EXPECT_LT(found["rmse_mm"]["after"], 0.0105);
}

// One experiment names it, a second confirms it, and no third is made.
TEST(Characterise, EndsWhenWhatIsMissingHasAName) {
  const ScratchFolder folder;
  folder.write("stage.toml", std::string("[baseline]\n") + kNoise + kFriction);
  folder.write("assumed.toml", std::string("[baseline]\n") + kNoise);
  const Outcome measured = standard_output(
      "characterise dc staircase load --bench --json --model " + (folder / "stage.toml").string() +
      " --until-named " + (folder / "assumed.toml").string() + " --out " + (folder / "data").string());
  ASSERT_EQ(measured.code, 0) << measured.text;
  const nlohmann::json rounds = nlohmann::json::parse(measured.text)["rounds"];
  ASSERT_EQ(rounds.size(), 2U) << measured.text;
  EXPECT_EQ(rounds[0]["experiment"], "dc");
  EXPECT_NE(rounds[1]["experiment"], "dc");
  for (const nlohmann::json& round : rounds) EXPECT_EQ(round["effect"], "coulomb_friction");
  EXPECT_EQ(rounds[1]["decision"], "Named: coulomb_friction, confirmed by a further experiment.");
}

TEST(Characterise, GoesThroughAllExperimentsWhereNothingIsMissing) {
  const ScratchFolder folder;
  folder.write("stage.toml", std::string("[baseline]\n") + kNoise);
  const Outcome measured = standard_output(
      "characterise dc load --bench --json --model " + (folder / "stage.toml").string() + " --until-named " +
      (folder / "stage.toml").string() + " --out " + (folder / "data").string());
  ASSERT_EQ(measured.code, 0) << measured.text;
  const nlohmann::json rounds = nlohmann::json::parse(measured.text)["rounds"];
  ASSERT_EQ(rounds.size(), 2U) << measured.text;
  for (const nlohmann::json& round : rounds) EXPECT_EQ(round["verdict"], "no_gap");
  EXPECT_EQ(rounds[1]["decision"], "No experiment is left.");
}

TEST(Characterise, ComparesOnlyWithAModelThatHasAStack) {
  const ScratchFolder folder;
  folder.write("rig.toml", "[baseline]\ndrive = \"force\"\nm = 1\nc_s = 1\nk = 1\n");
  const Outcome refused = biopsy("characterise dc --bench --until-named " + (folder / "rig.toml").string() +
                                 " --out " + (folder / "data").string());
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.text.find("--until-named"), std::string::npos) << refused.text;
  EXPECT_FALSE(fs::exists(folder / "data"));
}

// Row k is measured, then its voltage and its push act. One row off would show in every change of polarity.
TEST(Characterise, StoresEachRowAsTheModelOfADataSetHasIt) {
  const ScratchFolder folder;
  folder.write("stage.toml", std::string("[baseline]\n") + kNoise + kFriction);
  const Outcome measured = biopsy("characterise load dc --seed 7 --bench --model " +
                                  (folder / "stage.toml").string() + " --out " + (folder / "data").string());
  ASSERT_EQ(measured.code, 0) << measured.text;
  const sim::Dataset data = stored(folder / "data");
  ASSERT_EQ(data.runs.size(), 4U);
  sim::PlantModel truth = sim::read_model(folder / "stage.toml");
  for (std::size_t i = 0; i < data.runs.size(); ++i) {
    truth.noise_seed = 7 + i;
    const sim::RecordedRun& run = data.runs[i];
    const sim::RecordedRun again = sim::simulate(truth, run);
    EXPECT_LT(rms_mm(run.displacement, again.displacement), 0.0005) << run.name << ": 1 um is one code";
    EXPECT_DOUBLE_EQ(run.period, 1e-3);
    EXPECT_EQ(run.input.front(), 0.0);
    EXPECT_EQ(run.input.back(), 0.0);
  }
  EXPECT_GT(*std::max_element(data.runs.back().external_force.begin(), data.runs.back().external_force.end()),
            0.05);
  ASSERT_TRUE(data.sensor_noise);
  EXPECT_NEAR(*data.sensor_noise * 1e3, 0.010, 0.001);
}

TEST(Characterise, ItsStepTellsResistanceAndCapacitances) {
  const ScratchFolder folder;
  folder.write("stage.toml",
               std::string("[baseline]\nC1 = 1.6e-9\ntau = 5\nK = 0.75\n") + kNoise + kFriction);
  const Outcome measured = biopsy("characterise dc --bench --model " + (folder / "stage.toml").string() +
                                  " --out " + (folder / "data").string());
  ASSERT_EQ(measured.code, 0) << measured.text;
  const Outcome answer =
      biopsy("identify " + (folder / "data").string() + " --out " + (folder / "identified").string());
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json values = json_of(folder / "identified/identify.json")["values"];
  const double C1 = 1.6e-9, C2 = C1 / 0.75 - C1, R = 5.0 / (C1 + C2);  // eq. (7), (8)
  EXPECT_NEAR(values["C1"]["value"], C1, 0.03 * C1);
  EXPECT_NEAR(values["C2"]["value"], C2, 0.03 * C2);
  EXPECT_NEAR(values["R"]["value"], R, 0.03 * R);
  EXPECT_NE(answer.text.find(" to "), std::string::npos);
  EXPECT_FALSE(std::regex_search(answer.text, std::regex(R"((\S+) to \1\s)"))) << answer.text;
}

TEST(Characterise, EveryExperimentPassesUnderTheSupervisor) {
  const ScratchFolder folder;
  for (const std::string weight : {"0", "50", "250"}) {
    const Outcome answer =
        biopsy("characterise --bench --weight-g " + weight + " --out " + (folder / weight).string());
    EXPECT_EQ(answer.code, 0) << answer.text;
    const sim::Dataset data = stored(folder / weight);
    EXPECT_EQ(data.title.find("incomplete"), std::string::npos);
    EXPECT_EQ(data.runs.size(), 13U);
    for (const sim::RecordedRun& run : data.runs) {
      const double travel = *std::max_element(run.displacement.begin(), run.displacement.end());
      EXPECT_EQ(travel > 0.3e-3, !run.name.starts_with("dc-step")) << run.name << " moves " << travel << " m";
    }
    EXPECT_NE(file_content(folder / weight / "report.html").find("<svg"), std::string::npos);
  }
}

// The stage behind the paper's figures stands nearly still under the nominal stage's voltages.
TEST(Characterise, AStageThatNeedsMoreVoltageGetsItUnderTheSameSupervisor) {
  const ScratchFolder folder;
  const auto measured = [&](const std::string& scale) {
    return biopsy("characterise --bench --model " + (kSource / "sim/models/calibrated.toml").string() +
                  " --drive-scale " + scale + " --out " + (folder / scale).string());
  };
  const Outcome little = measured("1"), enough = measured("2");
  EXPECT_EQ(little.code, 0) << little.text;
  EXPECT_NE(little.text.find("--drive-scale 1.5"), std::string::npos) << little.text;
  EXPECT_EQ(enough.code, 0) << enough.text;
  for (const sim::RecordedRun& run : stored(folder / "2").runs) {
    const double travel = *std::max_element(run.displacement.begin(), run.displacement.end());
    EXPECT_EQ(travel > 0.5e-3, !run.name.starts_with("dc-step")) << run.name << " moves " << travel << " m";
  }
}

// The text without what stands from `from` up to `to`, or up to its end.
std::string without(std::string text, const std::string& from, const std::string& to = {}) {
  const std::size_t begin = text.find(from);
  const std::size_t end = to.empty() ? text.size() : text.find(to, begin);
  EXPECT_TRUE(begin < end && end <= text.size()) << from;
  return text.erase(begin, end - begin);
}

TEST(Characterise, NamesTheGuideThatTheStageBehindThePaperHas) {
  const ScratchFolder folder;
  const std::string truth = kSource / "sim/models/calibrated.toml";
  const std::string uncorrelated = without(file_content(truth), "# Of the deviations above");
  folder.write("assumed.toml", without(uncorrelated, "# A restoring force", "# The reading is late"));
  const Outcome measured = biopsy("characterise staircase --bench --drive-scale 2 --model " + truth +
                                  " --out " + (folder / "data").string());
  ASSERT_EQ(measured.code, 0) << measured.text;
  const nlohmann::json found = effect_found(folder);
  // A guide that slides after 0.03 mm, under 0.02 mm of noise, is dry friction: of what the spring yields
  // with.
  const sim::HystereticSpring guide = *sim::read_model(truth).effects.hysteretic_spring;
  const nlohmann::json& named = found["effects"][0];
  EXPECT_EQ(named["name"], "coulomb_friction");
  EXPECT_NEAR(named["parameters"]["force_N"]["value"], guide.pull(guide.yield),
              0.15 * guide.pull(guide.yield));
  EXPECT_EQ(named["confused_with"][0]["name"], "hysteretic_spring");
  EXPECT_LT(found["rmse_mm"]["after"], 0.1 * found["rmse_mm"]["before"].get<double>());
}

// Films that pull almost twice as hard as the nominal stage's: it would run into the end of its stroke.
TEST(Characterise, KeepsAndMarksWhatWasRecordedUntilTheSupervisorStopped) {
  const ScratchFolder folder;
  folder.write("strong.toml", std::string("[baseline]\neps_film = 10\n") + kNoise + kFriction);
  const std::string command = "characterise staircase load --bench --model " +
                              (folder / "strong.toml").string() + " --out " + (folder / "data").string();
  const Outcome answer = biopsy(command);
  ASSERT_EQ(answer.code, 3) << answer.text;
  EXPECT_NE(answer.text.find("H-"), std::string::npos) << answer.text;
  EXPECT_NE(answer.text.find("not begun"), std::string::npos) << answer.text;
  const sim::Dataset data = stored(folder / "data");
  EXPECT_TRUE(data.title.starts_with("Simulated"));
  EXPECT_NE(data.title.find("incomplete: staircase-50g stopped"), std::string::npos) << data.title;
  ASSERT_EQ(data.runs.size(), 1U);
  const sim::RecordedRun& run = data.runs.front();
  EXPECT_TRUE(file_content(folder / "data" / run.file).starts_with("# incomplete: stopped at "));
  EXPECT_EQ(run.input.back(), 0.0) << "recorded until the stage was off";
  EXPECT_LT(run.displacement.back(), 1e-3) << "and back";
  EXPECT_LT(*std::max_element(run.displacement.begin(), run.displacement.end()), 13e-3);
  EXPECT_NE(file_content(folder / "data/report.html").find("stopped"), std::string::npos);
}

// A push that is weaker than the guide's friction, 0.050 N, gives no information on the damping.
TEST(Characterise, TheFirstBlowIsStrongerThanTheGuide) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("characterise impact --bench --out " + (folder / "data").string());
  ASSERT_EQ(answer.code, 0) << answer.text;
  const sim::RecordedRun run = stored(folder / "data").runs.front();
  const auto blow = std::find_if(run.external_force.begin(), run.external_force.end(),
                                 [](double force_N) { return force_N > 0.0; }) -
                    run.external_force.begin();
  const auto depth = run.displacement.begin() + blow;
  const double before = std::accumulate(depth - 50, depth, 0.0) / 50.0;
  EXPECT_LT(*std::min_element(depth, depth + 250), before - 0.15e-3);
}

TEST(Characterise, SameSeedSameData) {
  const ScratchFolder folder;
  const auto run_in = [&](const std::string& name, int seed) {
    const Outcome answer = biopsy("characterise impact --bench --seed " + std::to_string(seed) + " --out " +
                                  (folder / name).string());
    EXPECT_EQ(answer.code, 0) << answer.text;
    return file_content(folder / name / "run-impact-50g.csv");
  };
  const std::string first = run_in("a", 3);
  EXPECT_EQ(first, run_in("b", 3));
  EXPECT_NE(first, run_in("c", 4));
}

TEST(Characterise, ADryRunSaysWhatWouldBeDoneAndMovesNothing) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("characterise dc impact --dry-run --out " + (folder / "out").string());
  EXPECT_EQ(answer.code, 0) << answer.text;
  for (const char* expected :
       {"dc-plus-50g", "impact-50g", "kV", "largest expected travel", "nothing was moved"})
    EXPECT_NE(answer.text.find(expected), std::string::npos) << expected << "\n" << answer.text;
  EXPECT_EQ(answer.text.find("staircase"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Characterise, RefusesWithWhatToDo) {
  const ScratchFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  folder.write("force.toml", "[baseline]\ndrive = \"force\"\nm = 0.1\nc_s = 1\nk = 100\n");
  const auto refuse = [&](const std::string& words, const std::string& expected) {
    const Outcome answer = biopsy("characterise " + words);
    EXPECT_EQ(answer.code, 2) << answer.text;
    EXPECT_NE(answer.text.find(expected), std::string::npos) << words << "\n" << answer.text;
    EXPECT_NE(answer.text.find("to do: "), std::string::npos) << answer.text;
  };
  refuse("dc" + out, "no patient, no needle");
  refuse("--bench", "--out");
  refuse("fly --bench" + out, "choose from: dc, staircase, load, impact, frequency");
  refuse("--device nidaqmx --bench" + out, "--commissioning");
  const std::string board = " --device-config " + (kSource / "drivers/nidaqmx/usb6211.toml").string() +
                            " --commissioning " + (folder / "none").string();
  refuse("dc --device nidaqmx --bench" + board + out, "libnidaqmx.so");
  refuse("load --device nidaqmx --bench" + board + out, "--weights-by-hand");
  refuse("load --device nidaqmx --weights-by-hand --bench" + board + out, "libnidaqmx.so");
  refuse("load --weights-by-hand --bench" + out, "--device nidaqmx");
  refuse("load --push-scale 10 --bench" + out, "--push-scale");
  refuse("--device toaster --bench" + out, "toaster");
  refuse("--weight-g 400 --bench" + out, "300 g");
  refuse("--weight-g nan --bench" + out, "--weight-g");
  for (const char* scale : {"0.5", "3.5", "nan", "-1"})
    refuse("--drive-scale " + std::string(scale) + " --bench" + out, "--drive-scale");
  for (const char* scale : {"0.5", "11", "nan"})
    refuse("--push-scale " + std::string(scale) + " --bench" + out, "--push-scale");
  refuse("--drive-scale 3 --weight-g 250 --bench" + out, "8.0 kV");
  refuse("--model " + (folder / "force.toml").string() + " --bench" + out, "force");
  EXPECT_FALSE(fs::exists(folder / "out"));
  fs::create_directories(folder / "out");
  folder.write("out/model.toml", std::string("[baseline]\n") + kNoise);
  refuse("impact --bench --model " + (folder / "out/model.toml").string() + out, "lies where the result");
  EXPECT_TRUE(fs::exists(folder / "out/model.toml"));
}

}  // namespace
}  // namespace biopsy::cli_tests
