// biopsy tune.
#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

const std::string kModel = "--model '" + (kSource / "sim/models/rehearsal.toml").string() + "'";

TEST(Tune, WritesAPageAndTheNumbersBehindIt) {
  const ScratchFolder scratch;
  const auto out = scratch.path() / "gains";
  const Outcome answer = biopsy("tune " + kModel + " --stages 1 --out '" + out.string() + "'");
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json result = json_of(out / "tune.json");
  ASSERT_EQ(result["controllers"].size(), 4U);
  const nlohmann::json& paper = result["controllers"][0];
  EXPECT_EQ(paper["K_p_kV_per_mm"], 0.8);
  EXPECT_EQ(paper["K_i_kV_per_mm_per_tick"], 0.005);
  EXPECT_FALSE(paper["feed_forward"]);
  EXPECT_EQ(result["met"], true);
  const nlohmann::json& margins = result["controllers"][1]["worst_margins"];
  EXPECT_GE(margins["gain_dB"], result["wanted"]["gain_dB"]);
  EXPECT_NE(file_content(out / "report.html").find("<svg"), std::string::npos);
}

TEST(Tune, WritesAControllerThatAPlanIsSealedWith) {
  const ScratchFolder scratch;
  const auto out = scratch.path() / "gains", plan = scratch.path() / "plan";
  ASSERT_EQ(biopsy("tune " + kModel + " --stages 0 --out '" + out.string() + "'").code, 0);
  const Outcome answer = biopsy("plan gap --controller '" + (out / "controller.toml").string() + "' --out '" +
                                plan.string() + "'");
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json tuned = json_of(out / "tune.json")["controllers"][1];
  const nlohmann::json sealed = json_of(plan / "report.json")["controller"];
  EXPECT_NEAR(sealed["K_p_kV_per_mm"], tuned["K_p_kV_per_mm"], 1e-3);
  EXPECT_NEAR(sealed["K_i_kV_per_mm_s"], 1e3 * double{tuned["K_i_kV_per_mm_per_tick"]}, 1e-2);
  EXPECT_NE(double{sealed["K_p_kV_per_mm"]}, 0.8);
}

TEST(Tune, LeavesAFolderOfSomeoneElseAlone) {
  const ScratchFolder scratch;
  scratch.write("mine.txt", "mine");
  const Outcome answer = biopsy("tune " + kModel + " --out '" + scratch.path().string() + "'");
  EXPECT_EQ(answer.code, 2);
  EXPECT_FALSE(std::filesystem::exists(scratch.path() / "tune.json"));
}

TEST(Tune, SaysWhichModelItCannotRead) {
  const Outcome answer = biopsy("tune --model nowhere.toml");
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.text.find("nowhere.toml"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::cli_tests
