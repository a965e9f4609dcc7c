// When a series that a scanner exports counts as complete. Inputs: DICOM files made with DCMTK, put into the
// folder one after another; the clock is the test's own.
#include "planner/imaging/io/watched_folder.hpp"

#include <gtest/gtest.h>

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
    for (const auto until = now + span; now < until; now += 100ms)
      if (auto series = watched.poll(now)) return series;
    return std::nullopt;
  }
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
  EXPECT_EQ(read_incoming_stacks(*series).size(), 3U);
  EXPECT_THROW(read_incoming(*series), ConfigError);  // no volume to plan on
}

TEST_F(WatchedFolderTest, TakesASlabThatSaysHowManySlicesItHas) {
  WatchedFolder watched(folder.path(), 1s);
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
  const std::vector<Volume> slab = read_incoming_stacks(*series);
  ASSERT_EQ(slab.size(), 1U);
  EXPECT_EQ(slab.front().grid.size.z(), 2);
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
