// That a simulated image cannot be filed under a patient. Inputs: a volume with the identity of a real
// patient.
#include "sim/scanner/simulated_mark.hpp"

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>
#include <gtest/gtest.h>

#include "planner/imaging/io/read_volume.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::sim {
namespace {

Volume of_a_patient(const std::string& series) {
  Volume volume;
  volume.grid.size = Eigen::Vector3i(30, 24, 4);
  volume.voxels.assign(volume.grid.voxel_count(), 100.0F);
  volume.voxels.back() = 900.0F;
  volume.identity = {"Doe^Jane", "4711", "1.2.3", series, "1.2.3.99", "MR", "t2", "20270115"};
  return volume;
}

TEST(SimulatedMark, GivesItsOwnPatientStudyAndFrame) {
  Volume first = of_a_patient("1.2.3.7"), second = of_a_patient("1.2.3.8");
  mark_simulated(first);
  mark_simulated(second);
  ScratchFolder folder;
  const auto files = write_dicom_series(first, folder / "first");
  const SeriesIdentity read = imaging::read_volume(folder / "first").identity;
  EXPECT_EQ(read.patient_name, "SIMULATED^Doe^Jane");
  EXPECT_EQ(read.patient_id, "SIMULATED-4711");
  EXPECT_NE(read.study_uid, "1.2.3");
  EXPECT_NE(read.frame_of_reference_uid, "1.2.3.99");
  EXPECT_NE(read.series_uid, "1.2.3.7");
  EXPECT_EQ(second.identity.frame_of_reference_uid, read.frame_of_reference_uid);
  DcmFileFormat content;
  ASSERT_TRUE(content.loadFile(files.front().c_str()).good());
  OFString type;
  content.getDataset()->findAndGetOFStringArray(DCM_ImageType, type);
  EXPECT_EQ(type, "DERIVED\\SECONDARY\\OTHER");
}

TEST(SimulatedMark, IsBurnedIntoEachSliceOnceAndLeavesTheRest) {
  Volume image = of_a_patient("1.2.3.7");
  mark_simulated(image);
  const SeriesIdentity once = image.identity;
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(image.at(0, 0, k), 900.0F);
    EXPECT_EQ(image.at(3, 0, k), 100.0F);
    EXPECT_EQ(image.at(20, 20, k), 100.0F);
  }
  mark_simulated(image);
  EXPECT_EQ(image.identity.patient_name, once.patient_name);
  EXPECT_EQ(image.identity.patient_id, once.patient_id);
}

}  // namespace
}  // namespace biopsy::sim
