// The image of a needle against what the physics says of it in limits. Inputs: uniform blocks and steps made
// here; expected values in closed form.
#include "sim/scanner/susceptibility/needle_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {
namespace {

Volume block(const Eigen::Vector3i& size, const Eigen::Vector3d& spacing, float value = 1000.0F) {
  Volume volume;
  volume.grid.size = size;
  volume.grid.X_SI.linear() = spacing.asDiagonal();
  volume.grid.X_SI.translation() = -0.5 * (size.cast<double>().array() - 1.0).matrix().cwiseProduct(spacing);
  volume.voxels.assign(volume.grid.voxel_count(), value);
  return volume;
}

// Texture, so that what is moved or blurred is seen.
Volume textured(const Eigen::Vector3i& size, const Eigen::Vector3d& spacing) {
  Volume volume = block(size, spacing);
  for (std::size_t n = 0; n < volume.voxels.size(); ++n)
    volume.voxels[n] += static_cast<float>(300.0 * std::sin(0.7 * static_cast<double>(n % 1009)));
  return volume;
}

double total(const Volume& volume) {
  return std::accumulate(volume.voxels.begin(), volume.voxels.end(), 0.0);
}

NeedleBody needle_along(const Direction& axis, double contrast_ppm = 190.0) {
  NeedleBody needle;
  needle.p_SE = -15.0 * axis.normalized();
  needle.p_ST = Point::Zero();
  needle.diameter = Millimetres(1.2);
  needle.susceptibility_ppm = needle.surroundings_ppm + contrast_ppm;
  return needle;
}

Sequence gradient_echo(double echo_time_ms) {
  Sequence sequence;
  sequence.echo_time_ms = echo_time_ms;
  return sequence;
}

Sequence spin_echo() {
  Sequence sequence;
  sequence.echo = Sequence::Echo::Spin;
  return sequence;
}

// Lost signal in mm^3, over the whole image.
double missing(const Volume& image, double tissue = 1000.0) {
  const double voxel = image.grid.spacing_mm().prod();
  return (static_cast<double>(image.voxels.size()) - total(image) / tissue) * voxel;
}

TEST(NeedleImage, IsTheVoidAloneWithoutContrast) {
  const Volume tissue = block({40, 40, 20}, {1.0, 1.0, 2.0});
  const NeedleBody needle = needle_along({1, 0.3, 0.2}, 0.0);
  const Volume image = image_with_needle(tissue, needle, gradient_echo(20.0));
  // Shaft from the tip to where it leaves the block, less two thirds of the cone.
  const double length = 20.0 / needle.axis_S().x() - 2.0 / 3.0 * 2.0;
  const double volume = std::numbers::pi * 0.36 * length;
  EXPECT_NEAR(missing(image), volume, 0.05 * volume);
  for (const float value : image.voxels) EXPECT_LE(value, 1000.001F);
}

// Ceramic differs from tissue by less than one part per million, glass by five, titanium by 191.
TEST(NeedleImage, GrowsWithTheContrastFromTheVoidAlone) {
  const Volume tissue = block({40, 40, 20}, {1.0, 1.0, 2.0});
  const double bare =
      missing(image_with_needle(tissue, needle_along(Direction::UnitX(), 0.0), gradient_echo(5.0)));
  std::vector<double> losses;
  for (const char* name : {"ceramic", "glass", "titanium", "nitinol"}) {
    NeedleBody needle = needle_along(Direction::UnitX());
    needle.susceptibility_ppm = needle_material(name).susceptibility_ppm;
    const double lost = missing(image_with_needle(tissue, needle, gradient_echo(5.0))) / bare;
    losses.push_back(lost);
  }
  EXPECT_TRUE(std::is_sorted(losses.begin(), losses.end()));
  EXPECT_NEAR(losses[0], 1.0, 0.15);
  EXPECT_LT(losses[1], 4.0);  // glass: 150 Hz at its surface
  EXPECT_GT(losses[2], 10.0);
}

TEST(NeedleImage, LeavesTheRestOfTheImageAsItIs) {
  const Volume tissue = textured({48, 48, 16}, {1.0, 1.0, 3.0});
  for (const Sequence& sequence : {gradient_echo(10.0), spin_echo()}) {
    const Volume image = image_with_needle(tissue, needle_along(Direction::UnitX(), -5.0), sequence);
    int same = 0;
    for (std::size_t n = 0; n < tissue.voxels.size(); ++n)
      same += std::abs(image.voxels[n] - tissue.voxels[n]) < 1e-2F;
    EXPECT_GT(same, static_cast<int>(0.9 * static_cast<double>(tissue.voxels.size())));
  }
}

TEST(NeedleImage, OfASpinEchoMovesSignalAndLosesNone) {
  const Volume tissue = block({64, 48, 24}, {1.0, 1.0, 2.0});
  const double bare = missing(image_with_needle(tissue, needle_along(Direction::UnitY(), 0.0), spin_echo()));
  const Volume image = image_with_needle(tissue, needle_along(Direction::UnitY()), spin_echo());
  EXPECT_NEAR(missing(image), bare, 0.02 * bare);
  EXPECT_GT(*std::max_element(image.voxels.begin(), image.voxels.end()), 1400.0F);  // piled up
}

// A field that changes by g across a voxel leaves sinc(g TE) of a gradient echo. Beside a shaft across the
// field, where it is nearly linear over a voxel of 1 mm.
TEST(NeedleImage, DephasesAsTheGradientOverTheVoxelSays) {
  const Volume tissue = block({41, 41, 5}, {1.0, 1.0, 1.0});
  NeedleBody needle = needle_along(Direction::UnitX());
  needle.p_ST = Point(40.0, 0.0, 0.0), needle.p_SE = Point(-40.0, 0.0, 0.0);
  Sequence sequence = gradient_echo(12.0);
  sequence.bandwidth_Hz_per_pixel = 1e5, sequence.slice_bandwidth_Hz = 0.0;
  sequence.b0_S = Direction::UnitY();
  const Volume image = image_with_needle(tissue, needle, sequence);
  for (int y : {5, 6, 7, 8, 10}) {
    const auto field = [&](double r) { return 95e-6 * sequence.larmor_Hz() * 0.36 / (r * r); };
    const double turns = (field(y - 0.5) - field(y + 0.5)) * 0.012;
    const double left = std::sin(std::numbers::pi * turns) / (std::numbers::pi * turns);
    EXPECT_NEAR(image.at(20, 20 + y, 2) / 1000.0F, std::abs(left), 0.03) << y;
  }
}

TEST(NeedleImage, ShrinksToTheVoidAsTheEchoTimeGoesToZero) {
  const Volume tissue = block({40, 40, 20}, {1.0, 1.0, 2.0});
  const NeedleBody needle = needle_along(Direction::UnitX());
  Sequence sequence = gradient_echo(0.0);
  sequence.bandwidth_Hz_per_pixel = 1e5, sequence.slice_bandwidth_Hz = 0.0;
  const double bare = missing(image_with_needle(tissue, needle_along(Direction::UnitX(), 0.0), sequence));
  double last = 0.0;
  for (double echo_time : {0.0, 1.0, 4.0, 16.0}) {
    sequence.echo_time_ms = echo_time;
    const double lost = missing(image_with_needle(tissue, needle, sequence));
    if (echo_time == 0.0) {
      EXPECT_NEAR(lost, bare, 0.03 * bare);
    }
    EXPECT_GT(lost, last);
    last = lost;
  }
}

// A uniform change of frequency is a shift of the whole picture; here the change beside a long shaft is near
// uniform at 20 mm: 2.5 Hz at 2.5 Hz a pixel.
TEST(NeedleImage, MovesAlongTheReadDirectionByTheOffsetOverTheBandwidth) {
  NeedleBody needle = needle_along(Direction::UnitZ());
  needle.p_SE = Point(0, 0, -60), needle.p_ST = Point(0, 0, 60), needle.shaft_length = Millimetres(300.0);
  for (int axis : {0, 1})
    for (bool reversed : {false, true}) {
      Volume tissue = block({60, 60, 3}, {1.0, 1.0, 1.0}, 0.0F);
      Eigen::Vector3i spot(30, 30, 1);
      spot[1 - axis] += 12;  // beside the shaft, across the read direction
      tissue.voxels[tissue.grid.index(spot.x(), spot.y(), 1)] = 1000.0F;
      Sequence sequence = spin_echo();
      sequence.b0_S = Direction::Unit(1 - axis);
      sequence.slice_bandwidth_Hz = 0.0, sequence.bandwidth_Hz_per_pixel = 10.0, sequence.read_axis = axis;
      sequence.read_reversed = reversed;
      const Volume image = image_with_needle(tissue, needle, sequence);
      double weight = 0.0, place = 0.0;
      for (int n = 0; n < 60; ++n) {
        Eigen::Vector3i at = spot;
        at[axis] = n;
        weight += static_cast<double>(image.at(at.x(), at.y(), 1));
        place += n * static_cast<double>(image.at(at.x(), at.y(), 1));
      }
      const double r = 12.5;  // of its centre: the middle of the block is between two voxels
      const double offset = 95e-6 * sequence.larmor_Hz() * 0.36 / (r * r);
      EXPECT_NEAR(weight, 1000.0, 1.0);
      EXPECT_NEAR(place / weight - 30.0, (reversed ? -offset : offset) / 10.0, 0.06) << axis << reversed;
    }
}

TEST(NeedleImage, ShiftsTheSliceThatIsExcited) {
  const Volume tissue = block({40, 40, 24}, {1.0, 1.0, 1.0});
  NeedleBody needle = needle_along(Direction::UnitX());
  Sequence wide = spin_echo(), narrow = spin_echo();
  wide.bandwidth_Hz_per_pixel = narrow.bandwidth_Hz_per_pixel = 1e5;
  wide.slice_bandwidth_Hz = 0.0, narrow.slice_bandwidth_Hz = 500.0;
  const Volume sharp = image_with_needle(tissue, needle, wide),
               bent = image_with_needle(tissue, needle, narrow);
  EXPECT_LT(*std::max_element(sharp.voxels.begin(), sharp.voxels.end()), 1001.0F);
  EXPECT_GT(*std::max_element(bent.voxels.begin(), bent.voxels.end()), 1300.0F);
  EXPECT_NEAR(missing(bent), missing(sharp), 0.05 * missing(sharp));
}

TEST(NeedleImage, MeasuresThroughTheProfileOfTheSlice) {
  Volume tissue = block({5, 5, 31}, {1.0, 1.0, 1.0}, 0.0F);
  for (int n = 0; n < 25; ++n)
    tissue.voxels[static_cast<std::size_t>(25 * 15 + n)] = 1000.0F;  // one bright plane
  NeedleBody far = needle_along(Direction::UnitZ());
  far.p_SE = Point(900, 0, -15), far.p_ST = Point(900, 0, 0);
  Sequence sequence = spin_echo();
  sequence.profile = Sequence::Profile::Gaussian, sequence.slice_thickness_mm = 4.0;
  const Volume image = image_with_needle(tissue, far, sequence);
  EXPECT_NEAR(image.at(2, 2, 13) / image.at(2, 2, 15), 0.5F, 0.02F);  // half the width at half the height
  sequence.profile = Sequence::Profile::Box, sequence.slice_thickness_mm = 3.0;
  const Volume box = image_with_needle(tissue, far, sequence);
  EXPECT_NEAR(box.at(2, 2, 14), 1000.0F / 3.0F, 0.5F);
  EXPECT_NEAR(box.at(2, 2, 13), 0.0F, 0.5F);
  const Volume flat = image_with_needle(block({5, 5, 31}, {1, 1, 1}), far, sequence);
  for (const float value : flat.voxels) EXPECT_NEAR(value, 1000.0F, 0.1F);
}

TEST(NeedleImage, RefusesSequencesThatNoScannerHas) {
  const Volume tissue = block({8, 8, 8}, {1, 1, 1});
  const NeedleBody needle;
  Sequence sequence;
  sequence.b0_T = 40.0;
  EXPECT_THROW(image_with_needle(tissue, needle, sequence), ConfigError);
  sequence = Sequence{};
  sequence.bandwidth_Hz_per_pixel = 0.0;
  EXPECT_THROW(image_with_needle(tissue, needle, sequence), ConfigError);
  sequence = Sequence{};
  sequence.echo_time_ms = NAN;
  EXPECT_THROW(image_with_needle(tissue, needle, sequence), ConfigError);
  EXPECT_THROW(image_with_needle(Volume{}, needle, Sequence{}), ConfigError);
}

}  // namespace
}  // namespace biopsy::sim
