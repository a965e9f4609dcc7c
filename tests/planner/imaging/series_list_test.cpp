// Claims about choosing one image among several.
#include "planner/imaging/io/series_list.hpp"

#include <gtest/gtest.h>

#include "tests/planner/imaging/dicom_fixture.hpp"
#include "tests/planner/imaging/refusal.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::imaging {
namespace {

struct TwoSeries : testing::Test {
  ScratchFolder folder;

  TwoSeries() {
    write_stack(folder / "deep/er", {}, 4);
    SliceRecipe other;
    other.series_uid = "1.2.3.7";
    other.columns = 10;
    write_stack(folder / "b", other, 3);
    write_content(folder / "notes.txt", "08 not an image");
  }
};

TEST_F(TwoSeries, AreListedWithSizeAndSpacing) {
  const std::vector<SeriesSummary> series = list_series(folder.path());
  ASSERT_EQ(series.size(), 2U);
  EXPECT_EQ(series[0].series_uid, "1.2.3.7");
  EXPECT_EQ(series[0].size, Eigen::Vector3i(10, 6, 3));
  EXPECT_EQ(series[1].series_uid, "1.2.3.4");
  EXPECT_EQ(series[1].description, "T2 test");
  EXPECT_EQ(series[1].modality, "MR");
  EXPECT_EQ(series[1].format, "DICOM");
  EXPECT_EQ(series[1].slices, 4);
  EXPECT_EQ(series[1].files.size(), 4U);
  EXPECT_TRUE(series[1].spacing_mm.isApprox(Eigen::Vector3d(0.5, 2, 3)));
  EXPECT_EQ(series[1].problem, "");
}

TEST_F(TwoSeries, AreNotChosenBetweenWithoutAWord) {
  for (const char* part : {"1.2.3.4", "1.2.3.7", "T2 test", "8 x 6 x 4", "10 x 6 x 3", "--series UID"})
    EXPECT_REFUSED(folder.path(), folder.path().string(), part);
}

TEST_F(TwoSeries, AreToldApartByTheirUid) {
  EXPECT_EQ(read_volume(folder.path(), "1.2.3.4").grid.size.z(), 4);
  EXPECT_EQ(read_volume(folder.path(), "1.2.3.7").grid.size.z(), 3);
  EXPECT_NE(refusal_of(folder.path(), "1.2.3").find("no series \"1.2.3\""), std::string::npos);
}

TEST_F(TwoSeries, KeepTheGoodOneReadableWhenTheOtherIsNoVolume) {
  std::filesystem::remove(folder / "b/b.dcm");
  const std::vector<SeriesSummary> series = list_series(folder.path());
  EXPECT_NE(series[0].problem.find("only 2 slices"), std::string::npos) << series[0].problem;
  EXPECT_EQ(series[0].slices, 2);
  EXPECT_EQ(read_volume(folder.path(), "1.2.3.4").grid.size.z(), 4);
}

TEST(SeriesList, ShowsADamagedFileInsteadOfHidingIt) {
  ScratchFolder folder;
  write_stack(folder.path(), {}, 4);
  write_content(folder / "d.dcm", file_content(folder / "d.dcm").substr(0, 300));
  const std::vector<SeriesSummary> series = list_series(folder.path());
  ASSERT_EQ(series.size(), 2U);
  EXPECT_EQ(series[0].slices, 3);
  EXPECT_NE(series[1].problem.find("d.dcm"), std::string::npos);
}

TEST(SeriesList, RefusesPathsWithoutImages) {
  ScratchFolder folder;
  EXPECT_REFUSED(folder.path(), folder.path().string(), "no image in this folder");
  EXPECT_REFUSED(folder / "nothing", "nothing", "no such file");
  write_content(folder / "notes.txt", "words");
  EXPECT_REFUSED(folder / "notes.txt", "notes.txt", "not an image");
}

}  // namespace
}  // namespace biopsy::imaging
