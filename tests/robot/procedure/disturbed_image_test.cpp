// Rehearsals with images that were disturbed: of a stage without a brake, whose drive switches twice a second
// in each, and of one whose brake does not hold.
#include <gtest/gtest.h>

#include "robot/procedure/procedure.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/report/procedure/verdict.hpp"
#include "sim/faults/fault_file.hpp"
#include "sim/plant/model_file.hpp"
#include "sim/plant/model_text.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

struct StageWithoutBrake : testing::Test {
  ScratchFolder folder;
  Case given = read_case("gap");

  void SetUp() override {
    sim::NotedModel noted = sim::read_noted_model(given.rehearsal.model);
    noted.model.brake.reset();
    folder.write("model.toml", sim::model_toml(noted.model, noted.notes));
    given.rehearsal.model = folder / "model.toml";
  }
  report::RunRecord rehearsed() {
    return rehearse(prepare(given, folder.path()), folder / "run", [](double, const std::string&) {});
  }
};

// A brake that holds a twenty-fifth of what it should: the needle sinks by 0.12 mm before the image, which
// itself shows nothing of it.
TEST(StageWithBrake, ConfirmsNoDepthByAnImageBeforeWhichTheNeedleSlipped) {
  const ScratchFolder folder;
  folder.write("weak.toml", "[[fault]]\nsignal = \"brake\"\nkind = \"scale\"\nfrom_s = 0.0\nvalue = 0.04\n");
  Case given = read_case("gap");
  given.rehearsal.scan = Seconds(2.0);  // a longer hold ends by itself, since the needle is not still
  const report::RunRecord run = rehearse(
      prepare(given, folder.path()), folder / "run", [](double, const std::string&) {}, {},
      sim::read_faults(folder / "weak.toml"));
  EXPECT_EQ(run.outcome, report::Outcome::Stopped);
  EXPECT_EQ(run.refusal, "the drive switched, or the needle slipped, while the image was taken");
  ASSERT_EQ(run.steps.size(), 1U);
  EXPECT_TRUE(run.steps[0].hv_switching_during_image);
  EXPECT_EQ(run.steps[0].check->verdict, DepthVerdict::Accept) << "the image itself";
  EXPECT_NE(run.steps[0].image_path.find("repeat-1"), std::string::npos) << "it was taken again";
}

// A laboratory's stage, or the paper's own, has none: its loop is rehearsed all the same.
TEST_F(StageWithoutBrake, IsRehearsedToTheEndAndTheVerdictSaysWhatItsImagesAreWorth) {
  const report::RunRecord run = rehearsed();
  EXPECT_EQ(run.outcome, report::Outcome::Completed);
  EXPECT_NE(
      report::verdict_sentence(run).find("in 1 of 1 image: with a patient such an image confirms no depth"),
      std::string::npos)
      << report::verdict_sentence(run);
}

TEST(StageWithBrake, HasImagesOfWhichTheVerdictNeedSayNothing) {
  const ScratchFolder folder;
  const report::RunRecord run =
      rehearse(prepare(read_case("gap"), folder.path()), folder / "run", [](double, const std::string&) {});
  EXPECT_EQ(run.outcome, report::Outcome::Completed);
  EXPECT_EQ(report::verdict_sentence(run).find("switched"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::robot
