// A confirmation image from a scanner's folder, through to the verdict. Inputs: the built-in phantom as
// planning image; images of it with a needle, rendered and written as DICOM into the folder by the test.
#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include "planner/imaging/registration/reslice.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/procedure/images/confirmation_image.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/scanner.hpp"
#include "sim/scanner/simulated_mark.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

// As a scanner labels what it measured; the simulator calls its images derived.
void say_original(const std::filesystem::path& file) {
  DcmFileFormat content;
  content.loadFile(file.c_str());
  content.loadAllDataIntoMemory();
  content.getDataset()->putAndInsertString(DCM_ImageType, "ORIGINAL\\PRIMARY\\M");
  content.saveFile(file.c_str(), EXS_LittleEndianExplicit);
}

struct ReceivedImage : testing::Test {
  ScratchFolder run, incoming;
  PreparedCase prepared;

  void SetUp() override {
    Case given = read_case("gap");
    given.images = {incoming.path(), std::chrono::milliseconds(100), std::chrono::milliseconds(1500), ""};
    prepared = prepare(given, run.path());
    ASSERT_TRUE(std::holds_alternative<Plan>(prepared.plan));
  }
  const Plan& plan() const { return std::get<Plan>(prepared.plan); }

  // The first step's check of an image with the needle where the plan has it, changed by `change`.
  template <class Change>
  report::StepResult check_of(Change&& change) {
    ConfirmationImages images(prepared, plan(), run / "out");
    EXPECT_TRUE(images.from_scanner());
    sim::ScanSettings settings;
    settings.needle = sim::NeedleArtefact{.p_SE = plan().X_SR.translation(),
                                          .axis_S = plan().X_SR.linear().col(2),
                                          .tip_depth = plan().steps[0].depth};
    settings.snr = 60.0;
    Volume image = sim::scan(prepared.image, settings);
    image.identity.series_uid = "1.2.3.4.5";
    change(image);
    for (const auto& file : sim::write_dicom_series(image, incoming / "series")) say_original(file);
    report::StepResult result;
    images.take(0, plan().steps[0].depth, std::chrono::milliseconds(2000), result);
    return result;
  }
};

// One slice of 2 mm about `centre`, its rows along `right`.
Volume plane_of(const Volume& image, const Point& centre, const Direction& right, const Direction& down) {
  constexpr int kSide = 96;
  constexpr double kPixel_mm = 0.8, kThick_mm = 2.0;
  Volume plane;
  plane.identity = image.identity;
  plane.grid.size = {kSide, kSide, 1};
  plane.grid.X_SI.linear() << kPixel_mm * right, kPixel_mm * down, kThick_mm * right.cross(down);
  plane.grid.X_SI.translation() = centre - 0.5 * (kSide - 1) * kPixel_mm * (right + down);
  const imaging::Sampler sampler(image);
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      double sum = 0.0;
      for (const double k : {-0.375, -0.125, 0.125, 0.375})
        sum += sampler.at(plane.grid.X_SI * Eigen::Vector3d(i, j, k)) / 4.0;
      plane.voxels.push_back(std::isnan(sum) ? 0.0F : static_cast<float>(sum));
    }
  return plane;
}

struct ReceivedPlanes : ReceivedImage {
  // The first step's check of three planes, in one series or one each. `change`: of the volume that plane
  // number n is cut from.
  template <class Change>
  report::StepResult check_of_planes(Change&& change) {
    prepared.given.images.confirmed_by = "R. Nurse";
    prepared.given.images.patience = std::chrono::milliseconds(5000);
    ConfirmationImages images(prepared, plan(), run / "out");
    const Point p_SE = plan().X_SR.translation();
    const Direction axis = plan().X_SR.linear().col(2), across = axis.unitOrthogonal(),
                    up = axis.cross(across);
    sim::ScanSettings settings;
    settings.needle = sim::NeedleArtefact{.p_SE = p_SE, .axis_S = axis, .tip_depth = plan().steps[0].depth};
    settings.snr = 60.0;
    const Volume image = sim::scan(prepared.image, settings);
    int number = 0;
    for (const auto& [right, down] : {std::pair(axis, across), std::pair(axis, up), std::pair(across, up)}) {
      Volume plane = plane_of(image, p_SE, right, down);
      plane.identity.series_uid = "1.2.3.4.6";
      change(++number, plane.identity);
      for (const auto& file : sim::write_dicom_series(plane, incoming / ("plane" + std::to_string(number))))
        say_original(file);
    }
    report::StepResult result;
    images.take(0, plan().steps[0].depth, std::chrono::milliseconds(2000), result);
    return result;
  }
};

TEST_F(ReceivedPlanes, OfOneSeriesOrOneEachAreCheckedAsOneImage) {
  for (const bool apart : {false, true}) {
    const report::StepResult result = check_of_planes([&](int number, SeriesIdentity& identity) {
      if (apart) identity.series_uid += "." + std::to_string(number);
    });
    std::filesystem::remove_all(incoming.path()), std::filesystem::create_directory(incoming.path());
    ASSERT_TRUE(result.check);
    EXPECT_TRUE(result.check->tip_found) << result.check->reason;
    EXPECT_NEAR(result.check->depth.value, plan().steps[0].depth.value, 0.7) << result.check->reason;
    EXPECT_FALSE(result.after.rgb.empty());
  }
}

TEST_F(ReceivedPlanes, OfWhichOneIsOfAnotherPatientOrFrameAreNoConfirmation) {
  verifies("R-62");
  const auto reason_of = [&](std::string SeriesIdentity::*field) {
    const report::StepResult result = check_of_planes([&](int number, SeriesIdentity& identity) {
      identity.series_uid += "." + std::to_string(number);
      if (number == 2) identity.*field = "1.2.3.4.99";
    });
    std::filesystem::remove_all(incoming.path()), std::filesystem::create_directory(incoming.path());
    EXPECT_EQ(result.check->verdict, DepthVerdict::Unsure);
    return result.check->reason;
  };
  EXPECT_NE(reason_of(&SeriesIdentity::frame_of_reference_uid).find("two frames of reference"),
            std::string::npos);
  EXPECT_NE(reason_of(&SeriesIdentity::patient_id).find("two patients"), std::string::npos);
}

// The writer states no time of acquisition, as for a file without an identity.
TEST_F(ReceivedImage, OfThisPatientIsCheckedOnceAPersonAnswersForIt) {
  prepared.given.images.confirmed_by = "R. Nurse";
  const report::StepResult result = check_of([](Volume&) {});
  ASSERT_TRUE(result.check);
  EXPECT_TRUE(result.check->tip_found) << result.check->reason;
  EXPECT_NEAR(result.check->depth.value, plan().steps[0].depth.value, 0.5);
  EXPECT_NE(result.image_path.find("series"), std::string::npos);
}

TEST_F(ReceivedImage, WithoutATimeLeavesTheDepthUnsure) {
  const report::StepResult result = check_of([](Volume&) {});
  ASSERT_TRUE(result.check);
  EXPECT_EQ(result.check->verdict, DepthVerdict::Unsure);
  EXPECT_NE(result.check->reason.find("when it was acquired"), std::string::npos) << result.check->reason;
}

TEST_F(ReceivedImage, OfAnotherPatientOrASimulatorIsNoConfirmation) {
  verifies("R-62");
  prepared.given.images.confirmed_by = "R. Nurse";
  EXPECT_NE(check_of([](Volume& image) {
              image.identity.patient_id = "OTHER";
            }).check->reason.find("another patient"),
            std::string::npos);
  std::filesystem::remove_all(incoming / "series");
  EXPECT_NE(check_of([](Volume& image) { sim::mark_simulated(image); }).check->reason.find("simulated"),
            std::string::npos);
}

TEST_F(ReceivedImage, ThatIsNotRepeatedKeepsItsReason) {
  ConfirmationImages images(prepared, plan(), run / "out");
  Volume image = prepared.image;
  image.identity.patient_id = "OTHER", image.identity.series_uid = "1.2.3.4.7";
  for (const auto& file : sim::write_dicom_series(image, incoming / "series")) say_original(file);
  report::StepResult result;
  for (const char* reason : {"of another patient", "no new image"}) {
    images.take(0, plan().steps[0].depth, std::chrono::milliseconds(2000), result);
    EXPECT_NE(result.check->reason.find(reason), std::string::npos) << result.check->reason;
    EXPECT_NE(result.check->reason.find("of another patient"), std::string::npos) << result.check->reason;
  }
}

TEST_F(ReceivedImage, ThatArrivesTooSlowlyIsNamedAsIncomplete) {
  prepared.given.images.patience = std::chrono::milliseconds(300);
  ConfirmationImages images(prepared, plan(), run / "out");
  std::filesystem::create_directory(incoming / "series");
  const auto files = sim::write_dicom_series(prepared.image, run / "elsewhere");
  for (std::size_t n = 0; n + 1 < files.size(); n += 2)  // every second slice, and all but the last
    if (n != 4) std::filesystem::copy(files[n], incoming / "series" / files[n].filename());
  report::StepResult result;
  images.take(0, Millimetres(1.0), std::chrono::milliseconds(2000), result);
  EXPECT_EQ(result.check->verdict, DepthVerdict::Unsure);
  EXPECT_NE(result.check->reason.find("no image was complete"), std::string::npos) << result.check->reason;
  EXPECT_NE(result.check->reason.find("uneven slices"), std::string::npos) << result.check->reason;
}

TEST_F(ReceivedImage, ThatDoesNotComeIsSaid) {
  prepared.given.images.patience = std::chrono::milliseconds(200);
  ConfirmationImages images(prepared, plan(), run / "out");
  report::StepResult result;
  images.take(0, Millimetres(1.0), std::chrono::milliseconds(2000), result);
  EXPECT_EQ(result.check->verdict, DepthVerdict::Unsure);
  EXPECT_NE(result.check->reason.find("no new image"), std::string::npos);
}

}  // namespace
}  // namespace biopsy::robot
