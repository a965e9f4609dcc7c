// The rendered needle against a real one. Inputs: a gradient echo of a needle in gel that lies along the
// static field (../shared/data/images/needle/gel_a; its README says where it is from). Sequence, field
// strength and needle are not stated there: 3 T and an 18 G titanium needle are assumed, and one number, the
// echo time, is fitted to it together with the place. Everything else is predicted.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "planner/imaging/io/read_volume.hpp"
#include "sim/scanner/susceptibility/needle_image.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::sim {
namespace {

// The second void of gel_a lies about voxel 120, 85 between the second and third slice; rows run from head to
// feet, 1.17 mm. The picture is interpolated: its noise is correlated over three pixels.
constexpr int kFirstColumn = 112, kFirstRow = 76, kColumns = 17, kRows = 22;
constexpr double kPixel_mm = 1.171875;

Volume window(const Volume& whole) {
  Volume part;
  part.grid.size = Eigen::Vector3i(kColumns, kRows, whole.grid.size.z());
  part.grid.X_SI = whole.grid.X_SI;
  part.grid.X_SI.translation() = whole.grid.X_SI * Point(kFirstColumn, kFirstRow, 0);
  for (int k = 0; k < whole.grid.size.z(); ++k)
    for (int j = 0; j < kRows; ++j)
      for (int i = 0; i < kColumns; ++i) part.voxels.push_back(whole.at(kFirstColumn + i, kFirstRow + j, k));
  return part;
}

float median_of(std::vector<float> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

// The mean of the two slices that the needle touches, as a share of the tissue's signal.
double left(const Volume& part, int i, int j, double tissue) {
  return 0.5 * static_cast<double>(part.at(i, j, 1) + part.at(i, j, 2)) / tissue;
}

// What is left of the signal, for each row the mean over 5.9 mm across the needle.
std::array<double, kRows> profile(const Volume& part, double tissue) {
  std::array<double, kRows> rows{};
  for (int j = 0; j < kRows; ++j)
    for (int i = 6; i <= 10; ++i) rows[static_cast<std::size_t>(j)] += left(part, i, j, tissue) / 5.0;
  return rows;
}

// Full width of the void at half of its depth, mm.
template <class Values>
double width(const Values& values) {
  const auto deepest = std::min_element(values.begin(), values.end());
  const double half = 0.5 * (1.0 + *deepest);
  auto from = deepest, to = deepest;
  while (from != values.begin() && *from < half) --from;
  while (to + 1 != values.end() && *to < half) ++to;
  const double before = (half - *from) / (*(from + 1) - *from),
               after = (half - *(to - 1)) / (*to - *(to - 1));
  return kPixel_mm * (static_cast<double>(to - from) - 1.0 - before + after);
}

// The same across the needle: the mean over the rows of the void, 7 mm.
std::array<double, kColumns> across(const Volume& part, double tissue) {
  std::array<double, kColumns> columns{};
  for (int i = 0; i < kColumns; ++i)
    for (int j = 6; j <= 11; ++j) columns[static_cast<std::size_t>(i)] += left(part, i, j, tissue) / 6.0;
  return columns;
}

NeedleBody needle_at(const Volume& gel, double row) {
  NeedleBody needle;
  needle.p_ST = gel.grid.X_SI * Point(8.0, row, 1.75);
  needle.p_SE = gel.grid.X_SI * Point(8.0, row + 40.0, 1.75);
  needle.tip_length = Millimetres(0.5);
  return needle;
}

struct Fit {
  double echo_time_ms = 0.0, tip_row = 0.0, rms = 1e9;
  Volume image;
};

// From row 5 on: before it a thinner part of the real needle goes on, which the model does not have.
void improve(const Volume& image, double echo_time_ms, double tip_row, const std::array<double, kRows>& real,
             double tissue, Fit& best) {
  const auto model = profile(image, tissue);
  double sum = 0.0;
  for (std::size_t j = 5; j < kRows; ++j) sum += (model[j] - real[j]) * (model[j] - real[j]) / (kRows - 5);
  if (std::sqrt(sum) < best.rms) best = {echo_time_ms, tip_row, std::sqrt(sum), image};
}

TEST(GelNeedle, HasTheVoidOfTheModelAndItsMillimetresBeyondTheTip) {
  const auto file = source_dir() / "../shared/data/images/needle/gel_a/needle_mag.nrrd";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "not installed: " << file;
  const Volume part = window(imaging::read_volume(file));
  const double tissue = static_cast<double>(median_of(part.voxels));
  const auto real = profile(part, tissue);
  Volume gel = part;
  std::fill(gel.voxels.begin(), gel.voxels.end(), static_cast<float>(tissue));
  Sequence sequence;
  sequence.b0_T = 3.0, sequence.bandwidth_Hz_per_pixel = 500.0;
  Fit best, bare;
  for (double row = 7.5; row <= 9.5; row += 0.5) {
    NeedleBody needle = needle_at(gel, row);
    const NeedleField field(needle, Direction::UnitZ());
    for (double echo_time : {1.0, 2.0, 3.0, 5.0, 8.0}) {
      sequence.echo_time_ms = echo_time;
      improve(image_with_needle(gel, field, sequence), echo_time, row, real, tissue, best);
    }
    needle.susceptibility_ppm = needle.surroundings_ppm;
    improve(image_with_needle(gel, needle, sequence), 0.0, row, real, tissue, bare);
  }
  EXPECT_LT(best.rms, 0.08) << "share of the tissue's signal";
  EXPECT_GT(bare.rms, 1.8 * best.rms) << "a void without a field explains it as well";
  EXPECT_TRUE(best.echo_time_ms > 1.0 && best.echo_time_ms < 8.0) << best.echo_time_ms;
  // 5.6 and 7.1 mm along, 3.8 and 3.8 mm across; the real one also has the end of the thicker part in it.
  EXPECT_NEAR(width(profile(best.image, tissue)), width(real), 2.0);
  EXPECT_NEAR(width(across(best.image, tissue)), width(across(part, tissue)), 1.2);
  // The model's void ends this far beyond the metal: where half of its loss on the axis is over.
  int row = static_cast<int>(best.tip_row);
  while (row > 0 && left(best.image, 8, row, tissue) < 0.6) --row;
  const double beyond = (best.tip_row - row - 0.5) * kPixel_mm;
  EXPECT_GT(beyond, 1.5);
  EXPECT_LT(beyond, 6.0);
}

}  // namespace
}  // namespace biopsy::sim
