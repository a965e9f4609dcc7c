// identify, reproduce, calibrate and design as commands, and what all of them refuse.
#include <gtest/gtest.h>

#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

TEST(Identify, FindsTheCircuitOfTheExampleThatWasMadeFromTheBaseline) {
  const ScratchFolder folder;
  const Outcome answer =
      biopsy("identify " + quoted(kSource / "docs/examples/current") + " --out " + quoted(folder / "out"));
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto values = json_of(folder / "out/identify.json")["values"];
  for (const auto& [name, truth] : {std::pair("C1", 2.0e-9), {"C2", 0.5e-9}, {"R", 2.76e9}, {"tau", 6.9}}) {
    const double std = values[name]["std"];
    EXPECT_TRUE(values[name]["known"]) << name;
    EXPECT_NEAR(values[name]["value"].get<double>(), truth, 3.0 * std) << name;
    EXPECT_LT(std, 0.02 * truth) << name;
  }
  const std::string model = file_content(folder / "out/model.toml");
  EXPECT_NE(model.find("std = "), std::string::npos);
  EXPECT_NE(model.find("current in Steps of 3 and 6 kV"), std::string::npos);
}

TEST(Identify, RefusesADataSetWithoutCurrentAndTouchesNothing) {
  const ScratchFolder folder;
  const Outcome answer =
      biopsy("identify " + quoted(kSource / "docs/examples/recorded") + " --out " + quoted(folder / "out"));
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.text.find("`current_uA`"), std::string::npos) << answer.text;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

// A second run clears the folder of the first: its inputs may not lie there.
TEST(EveryCommand, RefusesToClearWhatItReads) {
  const ScratchFolder folder;
  const std::filesystem::path set = kSource / "docs/examples/current";
  const std::string out = quoted(folder / "out");
  std::filesystem::copy(set, folder / "out", std::filesystem::copy_options::recursive);
  folder.write("out/.biopsy-run", "");
  std::filesystem::copy_file(kSource / "sim/models/rehearsal.toml", folder / "out/model.toml");
  const std::string model = " --model " + quoted(folder / "out/model.toml"), to = " --out " + out;
  const auto before = std::distance(std::filesystem::directory_iterator(folder / "out"), {});
  const std::string elsewhere = quoted(kSource / "sim/models/rehearsal.toml");
  for (const std::string& command :
       {"identify " + out + to, "identify " + quoted(set) + model + to, "calibrate --data " + out + to,
        "calibrate" + model + to, "reproduce" + model + to, "design" + model + to, "tune" + model + to,
        "simulate " + out + " --model " + elsewhere + to, "gap " + out + " --model " + elsewhere + to,
        "characterise dc --bench" + model + to, "dry-run gap" + model + to, "plan gap" + model + to}) {
    const Outcome answer = biopsy(command);
    EXPECT_EQ(answer.code, 2) << command << "\n" << answer.text;
    EXPECT_NE(answer.text.find("lies where the result is written"), std::string::npos)
        << command << answer.text;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "out"), {}), before);
  EXPECT_EQ(file_content(folder / "out/model.toml"), file_content(kSource / "sim/models/rehearsal.toml"));
}

TEST(Reproduce, RefusesAFigureThatIsNotThereAndListsThoseThatAre) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("reproduce 77 --out " + quoted(folder / "out"));
  EXPECT_EQ(answer.code, 2);
  for (const char* known : {"\"77\"", "7a", "9d", "13"})
    EXPECT_NE(answer.text.find(known), std::string::npos) << answer.text;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(Reproduce, OneFigureLeavesItsRowsAndItsPageAndMissesAreNoFailure) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("reproduce 6 --model " + quoted(kSource / "sim/models/rehearsal.toml") +
                                " --out " + quoted(folder / "out"));
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_EQ(answer.text.find('\033'), std::string::npos) << "colour into a pipe";
  const auto rows = json_of(folder / "out/reproduce.json")["rows"];
  ASSERT_GE(rows.size(), 3U);
  std::size_t missed = 0;
  for (const auto& row : rows) {
    EXPECT_EQ(row["figure"], "6");
    missed += row["ok"] == false ? 1U : 0U;
  }
  EXPECT_EQ(json_of(folder / "out/reproduce.json")["findings"].size(), missed);
  EXPECT_NE(file_content(folder / "out/report.html").find("Fig. 6"), std::string::npos);
}

// The example is of a stage near the baseline, which the search begins at.
TEST(Calibrate, FitsAStageOfOnesOwnAlone) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("calibrate --only-mine " + quoted(kSource / "docs/examples/recorded") +
                                " --model " + quoted(kSource / "sim/models/baseline.toml") +
                                " --starts 1 --evaluations 50 --out " + quoted(folder / "out"));
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto found = json_of(folder / "out/calibration.json");
  EXPECT_TRUE(found["rows"].empty()) << "no row of the paper counts";
  ASSERT_EQ(found["runs"].size(), 1U);
  EXPECT_TRUE(found["runs"][0]["followed"]) << answer.text;
  EXPECT_LT(found["told"].get<std::size_t>(), found["values"].size())
      << "one staircase does not tell everything";
  for (const auto& value : found["values"])
    EXPECT_FALSE(value["name"].get<std::string>().starts_with("joint."));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/paper.toml"));
  EXPECT_NE(file_content(folder / "out/calibrated.toml").find("fitted by biopsy calibrate"),
            std::string::npos);
  const std::string page = file_content(folder / "out/report.html");
  EXPECT_NE(page.find("Told by the data"), std::string::npos);
  EXPECT_NE(page.find("Combinations of parameters"), std::string::npos);
}

TEST(Calibrate, RefusesToLeaveFiguresOutOfAFitWithoutFigures) {
  const ScratchFolder folder;
  const Outcome answer =
      biopsy("calibrate --leave-one-out --only-mine " + quoted(kSource / "docs/examples/recorded") +
             " --out " + quoted(folder / "out"));
  EXPECT_EQ(answer.code, 2) << answer.text;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

// A model of which nothing was held out has no such column; the leakage model stands beside every model.
TEST(Reproduce, SaysOfAnotherModelThatItsFitIsNotKnown) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("reproduce 6 --model " + quoted(kSource / "sim/models/rehearsal.toml") +
                                " --out " + quoted(folder / "out"));
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto written = json_of(folder / "out/reproduce.json");
  EXPECT_TRUE(written["fitted"].is_null());
  for (const auto& row : written["rows"]) {
    EXPECT_TRUE(row["held_out"].is_null());
    EXPECT_TRUE(row["leakage_ok"].is_boolean()) << row["quantity"];
  }
}

TEST(Design, LeavesAPageAndDesignsThatMeetTheDemands) {
  const ScratchFolder folder;
  const Outcome answer = biopsy("design --model " + quoted(kSource / "sim/models/baseline.toml") + " --out " +
                                quoted(folder / "out"));
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto study = json_of(folder / "out/design.json");
  EXPECT_GE(study["best"].size(), 10U);
  for (const auto& stack : study["best"]) EXPECT_TRUE(stack["broken"].empty());
  EXPECT_LT(study["seconds"].get<double>(), 30.0);
  EXPECT_NE(file_content(folder / "out/report.html").find("Design study"), std::string::npos);
}

TEST(Design, RefusesAModelWithoutAStack) {
  const ScratchFolder folder;
  folder.write("rig.toml", "[baseline]\ndrive = \"force\"\nm = 0.08\nc_s = 1\nk = 140\n");
  const Outcome answer =
      biopsy("design --model " + quoted(folder / "rig.toml") + " --out " + quoted(folder / "out"));
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.text.find("no stack"), std::string::npos) << answer.text;
}

}  // namespace
}  // namespace biopsy::cli_tests
