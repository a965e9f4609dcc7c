// The workflow of docs/how-to/find-missing-effects.md: from measured runs to a better model to a rehearsal
// with it.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/robot/cli/command.hpp"
#include "tests/robot/cli/documented_fields.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

constexpr double kHiddenForce_N =
    0.050;  // given to the generator of tests/sim/gap, written nowhere in the data

// One search with --accept, then all claims on what it left behind.
class GapExample : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new ScratchFolder;
    fs::copy_file(kSource / "docs/examples/gap/stage.toml", model());
    first_ = biopsy(gap("first") + " --accept");
  }
  static void TearDownTestSuite() { delete folder_; }

  static fs::path model() { return *folder_ / "stage.toml"; }
  static fs::path in(const std::string& name) { return *folder_ / name; }
  static std::string gap(const std::string& out) {
    return "gap " + (kSource / "docs/examples/gap").string() + " --model " + model().string() + " --out " +
           in(out).string();
  }

  static inline ScratchFolder* folder_ = nullptr;
  static inline Outcome first_;
};

TEST_F(GapExample, NamesTheFrictionThatWasHidden) {
  ASSERT_EQ(first_.code, 0) << first_.text;
  const nlohmann::json found = json_of(in("first/gap.json"));
  ASSERT_EQ(found["verdict"], "effect") << first_.text;
  ASSERT_EQ(found["effects"].size(), 1U) << first_.text;
  EXPECT_EQ(found["effects"][0]["name"], "coulomb_friction");
  const auto& force = found["effects"][0]["parameters"]["force_N"];
  EXPECT_NEAR(force["value"], kHiddenForce_N, 0.02 * kHiddenForce_N);
  EXPECT_GT(found["rmse_mm"]["before"], 0.3);
  EXPECT_LT(found["rmse_mm"]["after"], 0.0105);  // the laser's own scatter is 0.010 mm
  EXPECT_EQ(found["held_out_runs"], nlohmann::json::array({"staircase-20g"}));
  EXPECT_FALSE(found["sentence"].get<std::string>().empty());
}

TEST_F(GapExample, AcceptsTheNewModelAndKeepsTheOldOne) {
  EXPECT_EQ(file_content(model()), file_content(in("first/model.toml")));
  EXPECT_EQ(file_content(in("stage.toml.1")), file_content(kSource / "docs/examples/gap/stage.toml"));
  EXPECT_NE(first_.text.find("the old one is kept as " + fs::canonical(in("stage.toml.1")).string()),
            std::string::npos)
      << first_.text;
}

TEST_F(GapExample, TheNewModelSaysWhereItsNumbersComeFrom) {
  const sim::NotedModel noted = sim::read_noted_model(model());
  ASSERT_TRUE(noted.model.effects.coulomb_friction);
  const sim::ValueNote& note = noted.notes.values.at("coulomb_friction.force_N");
  EXPECT_EQ(note.source, "Example: three open-loop runs of a needle stage: ramp-50g, staircase-20g, dc-80g");
  ASSERT_TRUE(note.std);
  EXPECT_GT(*note.std, 0.0);
  EXPECT_LT(std::abs(noted.model.effects.coulomb_friction->force - kHiddenForce_N), 4.0 * *note.std);
  // A number that was not measured again keeps its source.
  EXPECT_EQ(noted.notes.values.at("sensor_noise.std_mm").source, "data sheet of the laser");
  EXPECT_EQ(noted.notes.title, "Example: needle stage");
}

TEST_F(GapExample, RehearsesTheReferencePlansWithBothModels) {
  const nlohmann::json found = json_of(in("first/gap.json"));
  std::set<std::string> plans;
  for (const auto& margin : found["margins"]) {
    plans.insert(margin["plan"]);
    EXPECT_TRUE(margin["ok"]) << margin;
    EXPECT_LE(margin["after"], margin["limit"]) << margin;
  }
  EXPECT_EQ(plans, (std::set<std::string>{"gap", "liver"}));
  const auto drive = [&](const char* which) {
    for (const auto& margin : found["margins"])
      if (margin["plan"] == "liver" && margin["quantity"] == "drive voltage")
        return margin[which].get<double>();
    return 0.0;
  };
  EXPECT_GT(drive("after"), drive("before")) << "friction costs voltage";
  EXPECT_NE(file_content(in("first/report.html")).find("Used now"), std::string::npos);
}

TEST_F(GapExample, TheReferenceDescribesEveryFieldOfGapJson) {
  expect_documented(json_of(in("first/gap.json")), file_content(kSource / "docs/reference/commands.md"));
}

TEST_F(GapExample, FindsNothingMoreInTheSameData) {
  const std::string accepted = file_content(model());
  const Outcome again = biopsy(gap("again") + " --accept");
  ASSERT_EQ(again.code, 0) << again.text;
  EXPECT_EQ(json_of(in("again/gap.json"))["verdict"], "no_gap") << again.text;
  EXPECT_NE(again.text.find("nothing to accept"), std::string::npos) << again.text;
  EXPECT_EQ(file_content(model()), accepted);
  EXPECT_EQ(file_content(in("again/model.toml")), accepted);
  EXPECT_FALSE(fs::exists(in("stage.toml.2")));
}

TEST_F(GapExample, TheNextDryRunUsesTheAcceptedModel) {
  const Outcome rehearsed =
      biopsy("dry-run gap --model " + model().string() + " --out " + in("rehearsed").string());
  ASSERT_EQ(rehearsed.code, 0) << rehearsed.text;
  const nlohmann::json report = json_of(in("rehearsed/report.json"));
  EXPECT_EQ(report["outcome"], "completed");
  EXPECT_EQ(report["provenance"]["plant model, SHA-256"], hex(sha256(file_content(model()))));
  // The recheck predicted the figure of this dry-run.
  for (const auto& margin : json_of(in("first/gap.json"))["margins"])
    if (margin["plan"] == "gap" && margin["quantity"] == "drive voltage") {
      EXPECT_EQ(margin["after"].get<double>(), report["peak_kV"].get<double>());
    }
}

// Without tissue only the stage's own friction holds the loop (docs/explanation/model.md): the friction that
// was found makes the difference between a rehearsal that is stopped and one that arrives.
TEST_F(GapExample, WhatWasFoundDecidesWhetherARehearsalArrives) {
  const std::string air = "dry-run " + (kSource / "docs/examples/air.toml").string() + " --model ";
  EXPECT_EQ(biopsy(air + in("stage.toml.1").string() + " --out " + in("old").string()).code, 3);
  EXPECT_EQ(biopsy(air + model().string() + " --out " + in("new").string()).code, 0);
}

TEST(GapCommand, SaysWhichNumberOfTheBaselineIsWrong) {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  const std::string recorded = (kSource / "docs/examples/gap").string();
  folder.write("truth.toml", "[baseline]\nK = 0.86\n[effect.sensor_noise]\nstd_mm = 0.010\n");
  fs::copy_file(kSource / "docs/examples/gap/stage.toml", folder / "stage.toml");
  ASSERT_EQ(biopsy("simulate " + recorded + " --model " + in("truth.toml") + " --out " + in("data")).code, 0);
  const Outcome answer = biopsy("gap " + in("data") + " --model " + in("stage.toml") + " --out " + in("out") +
                                " --accept --no-recheck");
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json found = json_of(folder / "out/gap.json");
  EXPECT_EQ(found["verdict"], "parameter") << answer.text;
  EXPECT_TRUE(found["effects"].empty());
  EXPECT_TRUE(found["margins"].empty()) << "--no-recheck";
  EXPECT_NEAR(sim::read_model(folder / "stage.toml").baseline.K, 0.86, 0.005);
  EXPECT_TRUE(fs::exists(folder / "stage.toml.1"));
}

}  // namespace
}  // namespace biopsy::cli_tests
