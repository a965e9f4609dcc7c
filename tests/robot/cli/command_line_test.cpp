// What a person gets who types something wrong, or asks for help: a clear answer, exit code 2, and nothing
// half-written.
#include <fstream>

#include "tests/robot/cli/command.hpp"

namespace biopsy::stories {
namespace {

// Refused as bad input: three lines that name the mistake, the place and the remedy.
void expect_refused(const std::string& words, const std::string& named) {
  const Answer answer = biopsy(words);
  EXPECT_EQ(answer.code, 2) << words << "\n" << answer.text;
  EXPECT_NE(answer.text.find(named), std::string::npos) << words << "\n" << answer.text;
  EXPECT_NE(answer.text.find("to do: "), std::string::npos) << answer.text;
}

TEST(CommandLine, EveryCommandTeachesWithAnExample) {
  for (const char* command :
       {"dry-run", "plan", "check", "simulate", "image", "effects", "gap", "characterise"}) {
    const Answer answer = biopsy(std::string(command) + " --help");
    EXPECT_EQ(answer.code, 0);
    EXPECT_NE(answer.text.find("Example:\n  biopsy " + std::string(command)), std::string::npos)
        << answer.text;
  }
}

TEST(CommandLine, NoCommandOrAnUnknownOneIsAMistake) {
  EXPECT_EQ(biopsy("").code, 2);
  EXPECT_EQ(biopsy("fly").code, 2);
  EXPECT_EQ(biopsy("dry-run").code, 2);  // no --out
}

TEST(CommandLine, LogOptionsStandBeforeOrBehindTheCommandAndAreChecked) {
  for (const char* words :
       {"--log-level debug effects", "effects --log-level off", "effects --log-format json"})
    EXPECT_EQ(biopsy(words).code, 0) << words;
  EXPECT_EQ(biopsy("effects --log-level loud").code, 2);
  EXPECT_EQ(biopsy("effects --log-format xml").code, 2);
}

TEST(CommandLine, BadInputIsNamedWithARemedy) {
  const ScratchFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  expect_refused("dry-run no-such-case" + out, "no-such-case");
  expect_refused("dry-run --image /no/such/image --entry 0,0,0 --target 0,0,5" + out, "/no/such/image");
  expect_refused("dry-run --image . --entry 0,0 --target 0,0,5" + out, "--entry");
  expect_refused("dry-run --image . --entry 0,0,nan --target 0,0,5" + out, "--entry");
  expect_refused("dry-run --image . --entry 0,0,9999 --target 0,0,5" + out, "--entry");
  expect_refused("dry-run --image ." + out, "--entry");
  expect_refused("dry-run liver --image . --entry 0,0,0 --target 0,0,5" + out, "both");
  expect_refused("dry-run --model /no/such/model.toml" + out, "/no/such/model.toml");
  expect_refused("simulate /no/such/data --model /no/such/model.toml" + out, "/no/such");
  expect_refused("check --before /no/a --after /no/b --entry 0,0,0 --axis 0,0,0", "--axis");
  expect_refused("image /no/such/image", "/no/such/image");
}

TEST(CommandLine, AFolderThatIsNotOursIsLeftAlone) {
  const ScratchFolder folder;
  std::ofstream(folder / "letters.txt") << "mine";
  expect_refused("dry-run gap --out " + folder.path().string(), folder.path().string());
  EXPECT_EQ(file_content(folder / "letters.txt"), "mine");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(CommandLine, ACaseFileWithAMistakeNamesFileAndLine) {
  const ScratchFolder folder;
  const auto file = folder / "case.toml";
  const auto refuse = [&](const std::string& text, const std::string& named) {
    std::ofstream(file) << text;
    expect_refused("plan " + file.string() + " --out " + (folder / "out").string(), named);
  };
  refuse("[image]\nphantom = \"paper\"\n[target]\ndepth = 2.5\n", "case.toml:3");
  refuse("[image]\nphantom = \"paper\"\n[target]\ndepth_mm = \"deep\"\n", "case.toml:4");
  refuse("[image]\nphantom = \"paper\"\n[target]\ndepth_mm = 2.5\ndepht_mm = 2.5\n", "depht_mm");
  refuse("[image]\nphantom = \"paper\"\n[target]\ndepth_mm = 2.5\n[robot]\nweight_g = -3\n", "case.toml:6");
  refuse("[image\n", "case.toml:1");
  refuse(
      "[image]\npath = \"a\"\nlabels = \"b\"\n[target]\nentry_ras_mm = [0, 0, 0]\ntarget_ras_mm = [0, 0, "
      "5]\n[plan]\n"
      "layer = [{ name = \"fat\", from_mm = 0, to_mm = 9 }]\n",
      "both a table of layers and a label map");
  refuse("[image]\npath = \"nowhere\"\n[target]\nentry_ras_mm = [0, 0]\ntarget_ras_mm = [0, 0, 5]\n",
         "case.toml");
}

TEST(CommandLine, APlanMovesNothing) {
  const ScratchFolder folder;
  const Answer answer = biopsy("plan liver --out " + (folder / "out").string());
  EXPECT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json report = json_of(folder / "out/report.json");
  EXPECT_EQ(report["simulated_s"], 0.0);
  EXPECT_EQ(report["stages"].size(), 2U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/run.csv"));
}

TEST(CommandLine, ATargetOutOfReachIsRefusedWithTheDistanceAndWhatToDo) {
  const ScratchFolder folder;
  std::ofstream(folder / "far.toml") << "[image]\nphantom = \"paper\"\n[target]\ndepth_mm = 14.0\n";
  const Answer answer =
      biopsy("dry-run " + (folder / "far.toml").string() + " --out " + (folder / "out").string());
  EXPECT_EQ(answer.code, 3) << answer.text;
  const nlohmann::json report = json_of(folder / "out/report.json");
  EXPECT_EQ(report["outcome"], "refused");
  EXPECT_NE(report["refusal"].get<std::string>().find("14"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/report.html"));
}

TEST(CommandLine, SimulatedDataSetCanBeReadAgainAndIsTheSame) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "data");
  std::ofstream(folder / "data/dataset.toml")
      << "title = \"step\"\n[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = 50\n";
  std::ofstream csv(folder / "data/a.csv");
  csv << "time_s,voltage_V,displacement_mm\n";
  for (int i = 0; i < 2000; ++i) csv << i * 1e-3 << "," << (i / 250 % 2 == 0 ? 3000 : -3000) << ",0\n";
  csv.close();
  const std::string model = " --model " + (kHouse / "sim/models/baseline.toml").string();
  const Answer once =
      biopsy("simulate " + (folder / "data").string() + model + " --out " + (folder / "one").string());
  ASSERT_EQ(once.code, 0) << once.text;
  const Answer twice =
      biopsy("simulate " + (folder / "one").string() + model + " --out " + (folder / "two").string());
  ASSERT_EQ(twice.code, 0) << twice.text;
  EXPECT_EQ(file_content(folder / "one/a.csv"), file_content(folder / "two/a.csv"));
  EXPECT_EQ(file_content(folder / "one/a.csv").substr(0, 60),
            "time_s,voltage_V,displacement_mm,plate_b_mm,current_uA,exter");
}

}  // namespace
}  // namespace biopsy::stories
