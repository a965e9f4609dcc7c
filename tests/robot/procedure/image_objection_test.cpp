// Which arriving images can be the confirmation of this needle in this patient. Inputs: headers made here.
#include "robot/procedure/images/image_objection.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/safety/verifies.hpp"

namespace biopsy::robot {
namespace {

using namespace std::chrono_literals;

const auto kArrived = std::chrono::system_clock::time_point(1'800'000'000s);

imaging::IncomingSeries arriving() {
  imaging::IncomingSeries image;
  image.files = {"a.dcm"};
  image.identity = {"Doe^Jane", "4711", "1.2.3", "1.2.3.8", "1.2.3.99", "MR", "t2 confirm", "20270115"};
  image.image_type = "ORIGINAL\\PRIMARY\\M";
  image.acquired = kArrived + 20s;
  image.written = kArrived + 25s;
  return image;
}

ExpectedImage expected() {
  return {{"DOE^Jane^^", "4711", "1.2.3", "1.2.3.7", "1.2.3.99", "MR", "t2 plan", "20270115"},
          kArrived,
          kArrived + 60s,
          {},
          ""};
}

TEST(ImageObjection, IsNoneToAnImageOfThisPatientTakenNow) {
  EXPECT_EQ(image_objection(arriving(), expected()), "");
}

TEST(ImageObjection, NamesWhatIsWrong) {
  verifies("R-62");
  using Change = std::function<void(imaging::IncomingSeries&)>;
  const std::vector<std::pair<Change, const char*>> changes{
      {[](auto& i) { i.problem = "two slices are missing"; }, "cannot be read"},
      {[](auto& i) { i.identity.patient_id = "4712"; }, "another patient"},
      {[](auto& i) { i.identity.patient_name = "Roe^Jane"; }, "another patient"},
      {[](auto& i) { i.identity.frame_of_reference_uid = "1.2.3.98"; }, "frame of reference"},
      {[](auto& i) { i.identity.series_uid = "1.2.3.7"; }, "planning series"},
      {[](auto& i) { i.identity.patient_name = "SIMULATED^Doe"; }, "simulated"},
      {[](auto& i) { i.identity.modality = "CT"; }, "CT"},
      {[](auto& i) { i.identity.description = "3-plane Localizer"; }, "described"},
      {[](auto& i) { i.image_type = "DERIVED\\PRIMARY\\MPR"; }, "derived"},
      {[](auto& i) { i.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER"; }, "localiser"},
      {[](auto& i) { i.acquired = kArrived - 30s; }, "before the needle arrived"},
      {[](auto& i) { i.written = kArrived - 5s; }, "was written at"},
      {[](auto& i) { i.acquired = kArrived + 2h; }, "clock is wrong"},
      {[](auto& i) { i.acquired.reset(); }, "when it was acquired"},
      {[](auto& i) { i.identity.patient_id.clear(); }, "nobody answers"},
      {[](auto& i) { i.identity.frame_of_reference_uid.clear(); }, "nobody answers"}};
  for (const auto& [change, reason] : changes) {
    imaging::IncomingSeries image = arriving();
    change(image);
    const std::string said = image_objection(image, expected());
    EXPECT_NE(said.find(reason), std::string::npos) << reason << ": " << said;
  }
}

// No tolerance: a needle moves by millimetres in two seconds.
TEST(ImageObjection, IsToAnAcquisitionThatBeganBeforeTheNeedleArrived) {
  verifies("R-62");
  const auto said = [](std::chrono::milliseconds arrived_after, std::chrono::milliseconds acquired_after) {
    ExpectedImage needle = expected();
    needle.arrived = kArrived + arrived_after;
    imaging::IncomingSeries image = arriving();
    image.acquired = kArrived + acquired_after;
    return image_objection(image, needle);
  };
  EXPECT_EQ(said(0ms, 0ms), "");
  EXPECT_EQ(said(0ms, 1ms), "");
  EXPECT_EQ(said(400ms, 400ms), "");
  EXPECT_EQ(said(400ms, 1'000ms), "");
  EXPECT_NE(said(0ms, -1'900ms).find("1.9 s before the needle arrived"), std::string::npos)
      << said(0ms, -1'900ms);
  EXPECT_NE(said(0ms, -1'900ms).find("the scanner's clock is behind"), std::string::npos);
  EXPECT_NE(said(400ms, 150ms).find("0.2 s before the needle arrived"), std::string::npos)
      << said(400ms, 150ms);
  EXPECT_NE(said(400ms, -1'000ms).find("1.4 s before"), std::string::npos)
      << "a whole second, and a later one";
  EXPECT_NE(said(400ms, 0ms).find("only that it was acquired in the second of"), std::string::npos)
      << said(400ms, 0ms);
}

TEST(ImageObjection, IsToAFileThatWasWrittenBeforeTheNeedleArrived) {
  imaging::IncomingSeries image = arriving();
  image.written = kArrived - 1ms;
  EXPECT_NE(image_objection(image, expected()).find("was written at"), std::string::npos);
}

TEST(ImageObjection, IsToTimeThatRunsBackwards) {
  ExpectedImage second = expected();
  second.last_acquired = kArrived + 20s;
  EXPECT_NE(image_objection(arriving(), second), "");
  second.last_acquired = kArrived + 10s;
  EXPECT_EQ(image_objection(arriving(), second), "");
}

// Nothing can be of the patient of an image that names none.
TEST(ImageObjection, IsToAPlanningImageWithoutAPatientThatNobodyAnswersFor) {
  ExpectedImage unnamed = expected();
  unnamed.planning = {};
  EXPECT_NE(image_objection(arriving(), unnamed).find("planning image"), std::string::npos);
  unnamed.confirmed_by = "R. Nurse";
  EXPECT_EQ(image_objection(arriving(), unnamed), "");
}

// A person answers for what a file does not say, never for what it says wrongly.
TEST(ImageObjection, LetsAPersonAnswerForWhatIsNotSaid) {
  ExpectedImage answered = expected();
  answered.confirmed_by = "R. Nurse";
  imaging::IncomingSeries image;
  image.files = {"image.nii"};
  image.written = kArrived + 5s;
  EXPECT_NE(image_objection(image, expected()), "");
  EXPECT_EQ(image_objection(image, answered), "");
  image = arriving();
  image.identity.patient_id = "4712";
  EXPECT_NE(image_objection(image, answered), "");
}

}  // namespace
}  // namespace biopsy::robot
