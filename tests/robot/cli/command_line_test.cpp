// What is typed wrong is refused with exit code 2 and three lines (what, where, what to do), before anything
// is written; no option is ignored.
#include <fstream>

#include "tests/planner/imaging/nifti_fixture.hpp"
#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

void expect_refused(const std::string& words, const std::string& named) {
  const Outcome outcome = biopsy(words);
  EXPECT_EQ(outcome.code, 2) << words << "\n" << outcome.text;
  EXPECT_NE(outcome.text.find(named), std::string::npos) << words << "\n" << outcome.text;
  for (const char* line : {"error: ", "\nwhere: ", "\nto do: "})
    EXPECT_NE(outcome.text.find(line), std::string::npos) << words << "\n" << outcome.text;
}

TEST(CommandLine, NamesTheCommandThatWasMeant) {
  for (const auto& [typed, meant] :
       {std::pair("simulat docs", "`simulate`"), std::pair("dryrun liver", "`dry-run`"),
        std::pair("reprodcue 6", "`reproduce`"), std::pair("log verfiy x", "`verify`"),
        std::pair("keys inti", "`init`"), std::pair("safety_case", "`safety-case`")})
    expect_refused(typed, "did you mean " + std::string(meant));
  expect_refused("xyzzy", "there is no command `xyzzy`");
  expect_refused("", "a command is missing");
  expect_refused("log", "a command is missing");
}

TEST(CommandLine, NamesTheOptionThatWasMeant) {
  for (const auto& [typed, meant] :
       {std::pair("plan gap --ot x", "`--out`"), std::pair("dry-run --lvie gap --out x", "`--live`"),
        std::pair("gap data --modle m --out x", "`--model`"), std::pair("tune --stage=3", "`--stages`"),
        std::pair("keys init --day 3", "`--days`"), std::pair("image x --serie 1.2", "`--series`")})
    expect_refused(typed, "did you mean " + std::string(meant));
  expect_refused("dry-run -o x", "there is no option `-o`");
  expect_refused("plan gap liver --out x", "liver");
  expect_refused("dry-run", "--out");
}

// Each would be without effect, or mean something else than was typed.
TEST(CommandLine, RefusesAnOptionThatHasNoEffect) {
  const ScratchFolder folder;
  const std::string out = " --out " + (folder / "out").string(), models = (kSource / "sim/models").string(),
                    phantom = (folder / "p").string();
  ASSERT_EQ(biopsy("plan gap --out " + phantom).code, 0);
  fs::create_directories(folder / "two");
  fs::copy(folder / "p/planning", folder / "two/a", fs::copy_options::recursive);
  std::ofstream(folder / "two/b.nii", std::ios::binary) << imaging::nifti_content(imaging::nifti_header());
  const std::string ct = "check --before x --after y --entry 0,0,0 --axis 0,0,1 ";
  for (const auto& [typed, named] : std::vector<std::pair<std::string, std::string>>{
           {"plan gap --series 1.2.840.1" + out, "--series"},
           {"dry-run liver --domain 7" + out, "--live"},
           {"dry-run liver --network lo" + out, "--live"},
           {"dry-run liver --fifo 3" + out, "--live"},
           {"dry-run liver --keys k" + out, "--live"},
           {"dry-run liver --without-security" + out, "--live"},
           {"dry-run --live --keys k --without-security" + out, "excludes"},
           {"plan liver --labels l.nrrd" + out, "--labels"},
           {"plan liver --entry 0,0,0" + out, "--entry"},
           {"plan liver --model " + (kSource / "robot/procedure/cases/gap.toml").string() + out, "gap.toml"},
           {"plan liver --model " + models + "/tissues.toml" + out, "tissues.toml"},
           {"plan liver --fiducials " + models + "/paper.toml" + out, "paper.toml"},
           {"plan liver --seed -2" + out, "--seed"},
           {"plan liver --seed 2.5" + out, "2.5"},
           {"plan liver --seed 1e17" + out, "--seed"},
           {"design --seed -5" + out, "--seed"},
           {"calibrate --seed -1" + out, "--seed"},
           {"characterise dc --bench --seed -9" + out, "--seed"},
           {"tune --stages 2.5" + out, "2.5"},
           {"calibrate --evaluations 99999999999" + out, "--evaluations"},
           {"plan liver --out ''", "--out is empty"},
           {"gap d --model ''" + out, "--model is empty"},
           {ct + "--expected nan", "nan"},
           {ct + "--tip-offset -inf", "inf"},
           {"gap d --model m --window nan" + out, "nan"},
           {"image " + (folder / "two").string() + " --png " + (folder / "png").string(), "--series"},
           {"effects coulomb_friction --markdown", "--markdown"},
           {"characterise dc --bench --keys k" + out, "--keys"},
           {"characterise dc --bench --device-config f" + out, "--device-config"},
           {"characterise dc --bench --weights-by-hand" + out, "--weights-by-hand"},
           {"characterise dc --bench --weight-g inf" + out, "inf"},
           {"characterise dc --bench --device nidaqmx --device-config f --commissioning c --seed 4" + out,
            "--seed"},
           {"characterise dc --bench --device nidaqmx" + out, "--device-config"},
           {"up gap --open" + out, "--console"},
           {"up gap --port 80" + out, "--console"},
           {"up gap --console --port 70000" + out, "--port"},
           {"up gap --prepare --seconds 3" + out, "excludes"},
           {"up gap --prepare --console --open" + out, "excludes"},
           {"up gap --seconds nan" + out, "nan"},
           {"up gap --commissioning c" + out, "--commissioning"},
           {"up gap --device nidaqmx --device-config f --commissioning c --model m" + out, "--model"},
           {"commission --config f --yes" + out, "--config"},
           {"keys init --days 1e9 --keys " + (folder / "k").string(), "--days"},
           {"log show l --last -1", "--last"},
           {"help gap --markdown", "--markdown"}}) {
    expect_refused(typed, named);
    EXPECT_FALSE(fs::exists(folder / "out")) << typed;
  }
  EXPECT_FALSE(fs::exists(folder / "png"));
  EXPECT_FALSE(fs::exists(folder / "k"));
}

TEST(CommandLine, TakesLogOptionsBeforeAndBehindTheCommand) {
  for (const char* words :
       {"--log-level debug effects", "effects --log-level off", "effects --log-format json"})
    EXPECT_EQ(biopsy(words).code, 0) << words;
  expect_refused("effects --log-level loud", "loud");
  expect_refused("--log-format xml effects", "xml");
  expect_refused("--log-levle debug effects", "did you mean `--log-level`");
}

TEST(CommandLine, NamesBadInputWithARemedyAndWritesNothing) {
  const ScratchFolder folder;
  const std::string out = " --out " + (folder / "out").string();
  for (const auto& [typed, named] : std::vector<std::pair<std::string, std::string>>{
           {"dry-run no-such-case" + out, "no-such-case"},
           {"campaign gap --runs 1 --faults /no/such/faults.toml" + out, "faults.toml"},
           {"campaign gap --runs 1 --shard 1/2 --faults /no/such/faults.toml" + out, "faults.toml"},
           {"dry-run --image /no/such/image --entry 0,0,0 --target 0,0,5" + out, "/no/such/image"},
           {"dry-run --image . --entry 0,0 --target 0,0,5" + out, "--entry"},
           {"dry-run --image . --entry 0,0,nan --target 0,0,5" + out, "--entry"},
           {"dry-run --image . --entry 0,0,9999 --target 0,0,5" + out, "--entry"},
           {"dry-run --image ." + out, "--entry"},
           {"dry-run liver --image . --entry 0,0,0 --target 0,0,5" + out, "both"},
           {"dry-run --model /no/such/model.toml" + out, "/no/such/model.toml"},
           {"simulate /no/such/data --model /no/such/model.toml" + out, "/no/such"},
           {"check --before /no/a --after /no/b --entry 0,0,0 --axis 0,0,0", "--axis"},
           {"dry-run liver --seed 1e3" + out, "--seed: `1e3` is not written as a whole number"},
           {"dry-run liver --seed 2.5" + out, "--seed: `2.5` is not written as a whole number"},
           {"dry-run liver --seed x" + out, "--seed: `x` is not a number in the range"},
           {"image /no/such/image", "/no/such/image"}}) {
    expect_refused(typed, named);
    EXPECT_FALSE(fs::exists(folder / "out")) << typed;
  }
}

// Found before the needle is driven, and before the report of an earlier run is cleared.
TEST(CommandLine, RefusesPointsOutsideTheImageAndKeepsTheEarlierRun) {
  const ScratchFolder folder;
  const std::string earlier = (folder / "earlier").string(), image = (folder / "image/planning").string();
  ASSERT_EQ(biopsy("plan liver --out " + (folder / "image").string()).code, 0);
  ASSERT_EQ(biopsy("plan gap --out " + earlier).code, 0);
  const std::string report = file_content(folder / "earlier/report.json");
  for (const char* points :
       {"--entry 310,33,52 --target 310,33,48", "--entry -4.4,33.1,51.9 --target -4.4,33.1,-390",
        "--entry -4.4,-700,51.9 --target -4.4,-694,51.9"})
    for (const char* command : {"dry-run", "plan"})
      expect_refused(std::string(command) + " --image " + image + " " + points + " --out " + earlier,
                     "outside the image");
  EXPECT_EQ(file_content(folder / "earlier/report.json"), report);
  EXPECT_FALSE(fs::exists(folder / "earlier/images"));
}

TEST(CommandLine, LeavesAFolderAloneThatNoRunWrote) {
  const ScratchFolder folder;
  folder.write("letters.txt", "mine");
  expect_refused("dry-run gap --out " + folder.path().string(), folder.path().string());
  EXPECT_EQ(file_content(folder / "letters.txt"), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST(CommandLine, NamesFileAndLineOfAMistakeInACaseFile) {
  const ScratchFolder folder;
  const fs::path file = folder / "case.toml";
  const std::string phantom = "[image]\nphantom = \"paper\"\n[target]\n";
  for (const auto& [text, named] : std::vector<std::pair<std::string, std::string>>{
           {phantom + "depth = 2.5\n", "case.toml:3"},
           {phantom + "depth_mm = \"deep\"\n", "case.toml:4"},
           {phantom + "depth_mm = 2.5\ndepht_mm = 2.5\n", "depht_mm"},
           {phantom + "depth_mm = 2.5\n[robot]\nweight_g = -3\n", "case.toml:6"},
           {"[image\n", "case.toml:1"},
           {"[image]\npath = \"a\"\nlabels = \"b\"\n[target]\nentry_ras_mm = [0, 0, 0]\n"
            "target_ras_mm = [0, 0, 5]\n[plan]\nlayer = [{ name = \"fat\", from_mm = 0, to_mm = 9 }]\n",
            "both a table of layers and a label map"},
           {"[image]\npath = \"nowhere\"\n[target]\nentry_ras_mm = [0, 0]\ntarget_ras_mm = [0, 0, 5]\n",
            "case.toml"}}) {
    write_content(file, text);
    expect_refused("plan " + file.string() + " --out " + (folder / "out").string(), named);
    EXPECT_FALSE(fs::exists(folder / "out"));
  }
}

TEST(CommandLine, PlansWithoutMoving) {
  const ScratchFolder folder;
  const Outcome outcome = biopsy("plan liver --out " + (folder / "out").string());
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  const nlohmann::json report = json_of(folder / "out/report.json");
  EXPECT_EQ(report["simulated_s"], 0.0);
  EXPECT_EQ(report["stages"].size(), 2U);
  EXPECT_FALSE(fs::exists(folder / "out/run.csv"));
}

TEST(CommandLine, RefusesATargetOutOfReachWithTheDistanceAndWhatToDo) {
  const ScratchFolder folder;
  folder.write("far.toml", "[image]\nphantom = \"paper\"\n[target]\ndepth_mm = 14.0\n");
  const Outcome outcome =
      biopsy("dry-run " + (folder / "far.toml").string() + " --out " + (folder / "out").string());
  EXPECT_EQ(outcome.code, 3) << outcome.text;
  const nlohmann::json report = json_of(folder / "out/report.json");
  EXPECT_EQ(report["outcome"], "refused");
  EXPECT_NE(report["refusal"].get<std::string>().find("14"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "out/report.html"));
}

TEST(CommandLine, SimulatesADataSetThatCanBeSimulatedAgain) {
  const ScratchFolder folder;
  fs::create_directories(folder / "data");
  folder.write("data/dataset.toml",
               "title = \"step\"\n[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = 50\n");
  std::ostringstream csv;
  csv << "time_s,voltage_V,displacement_mm\n";
  for (int i = 0; i < 2000; ++i) csv << i * 1e-3 << "," << (i / 250 % 2 == 0 ? 3000 : -3000) << ",0\n";
  folder.write("data/a.csv", csv.str());
  const auto simulated = [&](const std::string& from, const std::string& to) {
    return biopsy("simulate " + (folder / from).string() + " --model " +
                  (kSource / "sim/models/baseline.toml").string() + " --out " + (folder / to).string());
  };
  const Outcome once = simulated("data", "one"), twice = simulated("one", "two");
  ASSERT_EQ(once.code, 0) << once.text;
  ASSERT_EQ(twice.code, 0) << twice.text;
  EXPECT_EQ(file_content(folder / "one/a.csv"), file_content(folder / "two/a.csv"));
  EXPECT_TRUE(file_content(folder / "one/a.csv")
                  .starts_with("time_s,voltage_V,displacement_mm,plate_b_mm,current_uA,exter"));
}

TEST(CommandLine, PrintsVersionCommitAndLibraries) {
  const std::string text = standard_output("--version").text;
  EXPECT_TRUE(text.starts_with("biopsy ")) << text;
  for (const char* part : {"\ncommit ", "Eigen 3.", "OpenCV 4.", "Cyclone DDS ", "fmt ", "DCMTK 3.", "Ceres ",
                           "SQLite 3.", "OpenSSL 3."})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
}

// What is counted is singular where there is one, and no zero has a sign.
TEST(CommandLine, PrintsNumbersAsPeopleWriteThem) {
  const ScratchFolder folder;
  const std::string run = (folder / "run").string();
  const Outcome planned = biopsy("plan gap --out " + run);
  EXPECT_NE(planned.text.find("1 step."), std::string::npos) << planned.text;
  const Outcome same = biopsy("check --before " + run + "/planning --after " + run +
                              "/planning --entry -4.4,33.1,51.9 --axis -0.94,0.04,-0.35");
  ASSERT_EQ(same.code, 0) << same.text;
  const Outcome image = biopsy("image " + run + "/planning");
  for (const Outcome& outcome : {planned, same, image})
    for (const char* wrong : {"1 stages", "1 files", "-0.00 ", "-0.00,", "-0.000,", "-0.0 "})
      EXPECT_EQ(outcome.text.find(wrong), std::string::npos) << wrong << " in\n" << outcome.text;
}

}  // namespace
}  // namespace biopsy::cli_tests
