// Rigid registration beside another program's: elastix (Debian: elastix), which shares no code with it.
// Inputs: real scans of one patient (../shared/data/images/mr), written as MetaImage for it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "planner/imaging/io/read_volume.hpp"
#include "planner/imaging/registration/register_rigid.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::imaging {
namespace {

namespace fs = std::filesystem;

void write_metaimage(const fs::path& file, const Volume& volume) {
  const Eigen::Vector3d spacing = volume.grid.spacing_mm();
  const Eigen::Matrix3d axes = volume.grid.X_SI.linear() * spacing.cwiseInverse().asDiagonal();
  const Point& origin = volume.grid.X_SI.translation();
  std::ofstream out(file, std::ios::binary);
  out << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nTransformMatrix "
         "=";
  for (int axis = 0; axis < 3; ++axis)
    for (int row = 0; row < 3; ++row) out << fmt::format(" {:.9f}", axes(row, axis));
  out << fmt::format(
      "\nOffset = {:.6f} {:.6f} {:.6f}\nElementSpacing = {:.6f} {:.6f} {:.6f}\nDimSize = {} {} {}\n"
      "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n",
      origin.x(), origin.y(), origin.z(), spacing.x(), spacing.y(), spacing.z(), volume.grid.size.x(),
      volume.grid.size.y(), volume.grid.size.z());
  out.write(reinterpret_cast<const char*>(volume.voxels.data()),
            static_cast<std::streamsize>(volume.voxels.size() * sizeof(float)));
}

constexpr const char* kParameters = R"((FixedInternalImagePixelType "float")
(MovingInternalImagePixelType "float")
(UseDirectionCosines "true")
(Registration "MultiResolutionRegistration")
(FixedImagePyramid "FixedSmoothingImagePyramid")
(MovingImagePyramid "MovingSmoothingImagePyramid")
(Interpolator "LinearInterpolator")
(ResampleInterpolator "FinalBSplineInterpolator")
(Resampler "DefaultResampler")
(Metric "AdvancedNormalizedCorrelation")
(Optimizer "AdaptiveStochasticGradientDescent")
(Transform "EulerTransform")
(AutomaticScalesEstimation "true")
(AutomaticTransformInitialization "false")
(NumberOfResolutions 3)
(MaximumNumberOfIterations 300)
(ImageSampler "RandomCoordinate")
(NumberOfSpatialSamples 4000)
(NewSamplesEveryIteration "true")
(RandomSeed 1)
(WriteResultImage "false")
)";

// "(Name 1 2 3)" of a file of elastix.
std::vector<double> numbers_of(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("(" + name + " ");
  std::vector<double> numbers;
  if (at == std::string::npos) return numbers;
  const std::size_t from = at + name.size() + 2;
  std::istringstream in(text.substr(from, text.find(')', at) - from));
  for (double number; in >> number;) numbers.push_back(number);
  return numbers;
}

// Where a point of the fixed image lies in the moving one: turned about y, then x, then z (ITK's Euler3D).
RigidTransform transform_of(const std::string& text) {
  const std::vector<double> p = numbers_of(text, "TransformParameters"),
                            c = numbers_of(text, "CenterOfRotationPoint");
  RigidTransform X = RigidTransform::Identity();
  if (p.size() != 6 || c.size() != 3) {
    ADD_FAILURE() << "no Euler transform: " << text;
    return X;
  }
  const Point centre(c[0], c[1], c[2]);
  X.linear() = (Eigen::AngleAxisd(p[2], Direction::UnitZ()) * Eigen::AngleAxisd(p[0], Direction::UnitX()) *
                Eigen::AngleAxisd(p[1], Direction::UnitY()))
                   .toRotationMatrix();
  X.translation() = centre + Point(p[3], p[4], p[5]) - X.linear() * centre;
  return X;
}

class BesideElastix : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(BesideElastix, MovesThePatientAlike) {
  const fs::path folder = source_dir() / "../shared/data/images/mr";
  if (!fs::exists(folder / "prostate_guidance_2")) GTEST_SKIP() << "no real images at " << folder;
  if (std::system("elastix --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "elastix is not installed";
  const Volume before = read_volume(folder / GetParam().first),
               after = read_volume(folder / GetParam().second);
  const Point centre(6, -27, 52), half(28, 24, 18);
  RegistrationSettings settings;
  settings.box = {centre - half, centre + half};
  settings.about = centre;
  const ScratchFolder files;
  write_metaimage(files / "after.mha", cropped(after, settings.box));
  write_metaimage(files / "before.mha", before);
  files.write("rigid.txt", kParameters);
  const std::string command = fmt::format(
      "elastix -f {0}/after.mha -m {0}/before.mha -p {0}/rigid.txt -out {0} -threads 1 "
      ">/dev/null 2>&1",
      files.path().string());
  ASSERT_EQ(std::system(command.c_str()), 0);
  const RigidTransform theirs = transform_of(file_content(files / "TransformParameters.0.txt"));
  const RigidTransform ours = register_rigid(before, after, settings).X_after_before.inverse();
  double apart_mm = 0.0;
  for (double x : {-1.0, 1.0})
    for (double y : {-1.0, 1.0})
      for (double z : {-1.0, 1.0}) {
        const Point p = centre + Point(x, y, z).cwiseProduct(half);
        apart_mm += (theirs * p - ours * p).norm() / 8.0;
      }
  const Eigen::Vector3d a = theirs * centre - centre, b = ours * centre - centre;
  fmt::print(
      "  {} -> {}: {:.2f} mm apart in the corners; the middle by elastix {:.2f} {:.2f} {:.2f}, here {:.2f} "
      "{:.2f} {:.2f} mm\n",
      GetParam().first, GetParam().second, apart_mm, a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
  EXPECT_LT(apart_mm, 0.5);
}

INSTANTIATE_TEST_SUITE_P(RealScans, BesideElastix,
                         testing::Values(std::pair("prostate_guidance", "prostate_guidance_2"),
                                         std::pair("prostate_planning", "prostate_guidance"),
                                         std::pair("prostate_planning", "prostate_guidance_2")));

}  // namespace
}  // namespace biopsy::imaging
