// When a series that a scanner exports counts as complete. Inputs: DICOM files made with DCMTK, put into the
// folder one after another; the clock is the test's own.
#include "planner/imaging/io/watched_folder.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "planner/imaging/io/dicom/dicom_time.hpp"
#include "robot/common/config_error.hpp"
#include "tests/planner/imaging/dicom_fixture.hpp"
#include "tests/planner/imaging/nifti_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"

namespace biopsy::imaging {
namespace {

using namespace std::chrono_literals;

struct WatchedFolderTest : testing::Test {
  ScratchFolder source, folder;
  std::chrono::steady_clock::time_point now{};

  void SetUp() override {
    SliceRecipe recipe;
    recipe.series_uid = "1.2.3.9";
    recipe.change = [](DcmDataset& dataset) {
      dataset.putAndInsertString(DCM_ImagesInAcquisition, "5");
      dataset.putAndInsertString(DCM_AcquisitionDate, "20260301");
      dataset.putAndInsertString(DCM_AcquisitionTime, "101530.25");
      dataset.putAndInsertString(DCM_TimezoneOffsetFromUTC, "+0100");
    };
    write_stack(source.path(), recipe, 5);
  }
  void arrive(const std::string& name) { std::filesystem::copy_file(source / name, folder / name); }
  // Polls for `span` in steps of 100 ms; what came.
  std::optional<IncomingSeries> wait(WatchedFolder& watched, std::chrono::milliseconds span) {
    const IncomingImage image = wait_for_image(watched, span);
    if (image.empty()) return std::nullopt;
    EXPECT_EQ(image.size(), 1U);
    return image.front();
  }
  IncomingImage wait_for_image(WatchedFolder& watched, std::chrono::milliseconds span) {
    for (const auto until = now + span; now < until; now += 100ms)
      if (IncomingImage image = watched.poll(now); !image.empty()) return image;
    return {};
  }
};

// One slice of a series of its own, as most scanners export three planes.
struct WatchedPlanes : WatchedFolderTest {
  SliceRecipe recipe;
  std::string stated, frame = "1.2.3.5", patient = "phantom";

  void SetUp() override {
    recipe.change = [this](DcmDataset& dataset) {
      dataset.putAndInsertString(DCM_SliceThickness, "3");
      if (!stated.empty()) dataset.putAndInsertString(DCM_ImagesInAcquisition, stated.c_str());
      dataset.putAndInsertString(DCM_FrameOfReferenceUID, frame.c_str());
      dataset.putAndInsertString(DCM_PatientID, patient.c_str());
    };
  }
  void arrives(const std::string& name, const std::string& orientation, double z_mm = 0.0) {
    recipe.series_uid = "1.2.3.20." + name;
    recipe.orientation = orientation;
    recipe.position[2] = z_mm;
    write_slice(folder / (name + "-" + std::to_string(static_cast<int>(z_mm)) + ".dcm"), recipe);
  }
  void axial(double z_mm = 0.0) { arrives("1", "1\\0\\0\\0\\1\\0", z_mm); }
  void coronal() { arrives("2", "1\\0\\0\\0\\0\\-1"); }
  void sagittal() { arrives("3", "0\\1\\0\\0\\0\\-1"); }
};

TEST_F(WatchedFolderTest, ReturnsASeriesOnceItIsWholeAndQuiet) {
  WatchedFolder watched(folder.path(), 1s);
  for (const char* name : {"a.dcm", "b.dcm", "c.dcm", "d.dcm"}) {
    arrive(name);
    EXPECT_FALSE(wait(watched, 700ms)) << name;
  }
  EXPECT_FALSE(wait(watched, 2500ms));  // quiet, evenly spaced, but four of five
  arrive("e.dcm");
  EXPECT_FALSE(wait(watched, 900ms));
  const auto series = wait(watched, 2s);
  ASSERT_TRUE(series);
  EXPECT_EQ(series->problem, "");
  EXPECT_EQ(series->files.size(), 5U);
  EXPECT_EQ(series->identity.series_uid, "1.2.3.9");
  ASSERT_TRUE(series->acquired);
  EXPECT_EQ(*series->acquired, time_of_dicom_texts("20260301", "091530.25", "+0000"));
  EXPECT_EQ(read_incoming(*series).grid.size.z(), 5);
  EXPECT_FALSE(wait(watched, 10s));  // once
}

TEST_F(WatchedFolderTest, DoesNotLookAtWhatWasThereBefore) {
  for (const char* name : {"a.dcm", "b.dcm", "c.dcm", "d.dcm", "e.dcm"}) arrive(name);
  WatchedFolder watched(folder.path(), 1s);
  EXPECT_FALSE(wait(watched, 10s));
  write_content(folder / "image.nii", nifti_content(nifti_header()));
  const auto series = wait(watched, 3s);
  ASSERT_TRUE(series);
  EXPECT_EQ(series->files, std::vector{folder / "image.nii"});
  EXPECT_TRUE(series->identity.patient_id.empty());
}

TEST_F(WatchedFolderTest, TellsOfASeriesThatStaysIncomplete) {
  WatchedFolder watched(folder.path(), 1s);
  for (const char* name : {"a.dcm", "b.dcm", "d.dcm", "e.dcm"}) arrive(name);  // a gap
  EXPECT_FALSE(wait(watched, 3500ms));
  const auto series = wait(watched, 3s);
  ASSERT_TRUE(series);
  EXPECT_NE(series->problem, "");
}

TEST_F(WatchedFolderTest, WaitsForAFileThatIsStillWritten) {
  WatchedFolder watched(folder.path(), 1s);
  for (const char* name : {"a.dcm", "b.dcm", "c.dcm", "d.dcm"}) arrive(name);
  const std::string whole = file_content(source / "e.dcm");
  for (std::size_t part = 1; part <= 3; ++part) {
    write_content(folder / "e.dcm", whole.substr(0, whole.size() * part / 3));
    EXPECT_FALSE(wait(watched, 800ms)) << part;
  }
  ASSERT_TRUE(wait(watched, 2s));
}

// What a confirmation scan usually is: one slice in each of three orientations.
TEST_F(WatchedFolderTest, TakesThreePlanesAsOneImage) {
  WatchedFolder watched(folder.path(), 1s);
  SliceRecipe recipe;
  recipe.series_uid = "1.2.3.11";
  recipe.change = [](DcmDataset& dataset) { dataset.putAndInsertString(DCM_SliceThickness, "3"); };
  for (const char* orientation : {"1\\0\\0\\0\\1\\0", "1\\0\\0\\0\\0\\-1", "0\\1\\0\\0\\0\\-1"}) {
    recipe.orientation = orientation;
    write_slice(folder / (std::to_string(recipe.position[0]) + ".dcm"), recipe);
    recipe.position[0] += 1.0;
    EXPECT_FALSE(wait(watched, 1500ms));
  }
  EXPECT_FALSE(wait(watched, 2000ms));  // it does not say that there are no more
  const auto series = wait(watched, 3s);
  ASSERT_TRUE(series);
  EXPECT_EQ(series->problem, "");
  EXPECT_EQ(read_incoming_stacks({*series}).size(), 3U);
  EXPECT_THROW(read_incoming(*series), ConfigError);  // no volume to plan on
}

TEST_F(WatchedFolderTest, TakesASlabThatSaysHowManySlicesItHas) {
  WatchedFolder watched(folder.path(), 1s, 1);
  SliceRecipe recipe;
  recipe.series_uid = "1.2.3.12";
  recipe.change = [](DcmDataset& dataset) {
    dataset.putAndInsertString(DCM_ImagesInAcquisition, "2");
    dataset.putAndInsertString(DCM_SliceThickness, "3");
  };
  write_slice(folder / "one.dcm", recipe);
  EXPECT_FALSE(wait(watched, 2500ms));
  recipe.position[2] = 3.0;
  write_slice(folder / "two.dcm", recipe);
  const auto series = wait(watched, 2s);
  ASSERT_TRUE(series);
  EXPECT_EQ(series->problem, "");
  const std::vector<Volume> slab = read_incoming_stacks({*series});
  ASSERT_EQ(slab.size(), 1U);
  EXPECT_EQ(slab.front().grid.size.z(), 2);
}

TEST_F(WatchedPlanes, OfASeriesEachAreOneImage) {
  WatchedFolder watched(folder.path(), 1s);
  stated = "1";
  for (const auto& arrive : {&WatchedPlanes::sagittal, &WatchedPlanes::coronal}) {
    (this->*arrive)();
    EXPECT_TRUE(wait_for_image(watched, 3500ms).empty());
  }
  axial();
  EXPECT_TRUE(wait_for_image(watched, 900ms).empty());
  const IncomingImage image =
      wait_for_image(watched, 1s);  // nothing is missing: no longer than one quiet time
  ASSERT_EQ(image.size(), 3U);
  for (const IncomingSeries& series : image) EXPECT_EQ(series.problem, "");
  EXPECT_EQ(read_incoming_stacks(image).size(), 3U);
  EXPECT_TRUE(wait_for_image(watched, 10s).empty());  // once
}

TEST_F(WatchedPlanes, AreTwoWhereNoThirdComes) {
  WatchedFolder watched(folder.path(), 1s);
  coronal();
  axial(0.0), axial(3.0), axial(6.0);  // a slab across, of three slices
  EXPECT_TRUE(wait_for_image(watched, 3500ms).empty());
  const IncomingImage image = wait_for_image(watched, 2s);
  ASSERT_EQ(image.size(), 2U);
  EXPECT_EQ(read_incoming_stacks(image).size(), 2U);
}

// A scanner may take each plane for longer than any quiet time.
TEST_F(WatchedPlanes, AreWaitedForWhereTheirNumberIsKnown) {
  WatchedFolder watched(folder.path(), 1s, 3);
  axial(), sagittal();
  EXPECT_TRUE(wait_for_image(watched, 60s).empty());
  EXPECT_EQ(watched.incomplete(), "2 of 3 planes");
  coronal();
  EXPECT_EQ(wait_for_image(watched, 6s).size(), 3U);
  EXPECT_EQ(watched.incomplete(), "");
}

// Some state the slices of all planes in each.
TEST_F(WatchedPlanes, MayCountTheSlicesOfAllTogether) {
  WatchedFolder watched(folder.path(), 1s);
  stated = "3";
  axial(), coronal();
  EXPECT_TRUE(wait_for_image(watched, 3500ms).empty());
  sagittal();
  const IncomingImage image = wait_for_image(watched, 2500ms);
  ASSERT_EQ(image.size(), 3U);
  EXPECT_EQ(image.back().problem, "");
}

TEST_F(WatchedPlanes, ThatWereNotTakenTogetherAreNoImage) {
  const std::vector<std::pair<std::string WatchedPlanes::*, const char*>> changes{
      {&WatchedPlanes::frame, "two frames of reference"}, {&WatchedPlanes::patient, "two patients"}};
  for (const auto& [what, problem] : changes) {
    WatchedFolder watched(folder.path(), 1s, 3);
    axial(), coronal();
    const std::string usual = std::exchange(this->*what, "another");
    sagittal();
    this->*what = usual;
    const IncomingImage image = wait_for_image(watched, 6s);
    ASSERT_EQ(image.size(), 3U);
    EXPECT_NE(image.front().problem.find(problem), std::string::npos) << image.front().problem;
  }
}

TEST_F(WatchedPlanes, OfOneOrientationAreNotMixed) {
  WatchedFolder watched(folder.path(), 1s);
  axial(), coronal();
  arrives("4", "1\\0\\0\\0\\0.9986295\\0.0523360");  // axial again, turned by 3 degrees
  const IncomingImage image = wait_for_image(watched, 6s);
  ASSERT_EQ(image.size(), 3U);
  EXPECT_NE(image.front().problem.find("two planes of one orientation"), std::string::npos);
}

TEST_F(WatchedFolderTest, SaysWhatIsIncomplete) {
  WatchedFolder watched(folder.path(), 1s);
  EXPECT_EQ(watched.incomplete(), "");
  for (const char* name : {"a.dcm", "b.dcm", "c.dcm"}) {
    arrive(name);
    EXPECT_FALSE(wait(watched, 700ms));
  }
  EXPECT_EQ(watched.incomplete(), "3 of 5 slices have arrived");
}

TEST_F(WatchedFolderTest, RefusesAFolderThatIsNone) {
  EXPECT_THROW(WatchedFolder(folder / "nowhere", 1s), ConfigError);
}

TEST(DicomTime, IsReadStrictly) {
  const auto noon = time_of_dicom_texts("20240229", "120000", "+0000");
  ASSERT_TRUE(noon);
  EXPECT_EQ(std::chrono::duration_cast<std::chrono::seconds>(noon->time_since_epoch()).count(), 1709208000);
  EXPECT_EQ(time_of_dicom_texts("20240229", "140000.5", "+0200"), *noon + 500ms);
  EXPECT_TRUE(time_of_dicom_texts("20240229", "120000", ""));
  for (const auto& [date, time, zone] :
       std::initializer_list<std::array<const char*, 3>>{{"20230229", "120000", "+0000"},
                                                         {"2024", "120000", "+0000"},
                                                         {"20240229", "2500", "+0000"},
                                                         {"20240229", "1200000", "+0000"},
                                                         {"20240229", "120000", "0100"},
                                                         {"", "", ""},
                                                         {"20240229", "12:00:00", ""},
                                                         {"20240229", "120000.x", ""}})
    EXPECT_FALSE(time_of_dicom_texts(date, time, zone)) << date << " " << time << " " << zone;
}

}  // namespace
}  // namespace biopsy::imaging
