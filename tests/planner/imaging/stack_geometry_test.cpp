// Claims about stacking slices: properties over random, seeded places.
#include "planner/imaging/io/dicom/stack_geometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

// `count` slices along the normal of a random orientation, first at a random place.
std::vector<SlicePlane> random_stack(std::mt19937& random, int count, double gap) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond(any(random), any(random), any(random), any(random)).normalized().toRotationMatrix();
  const Point p_first = 200.0 * Point(any(random), any(random), any(random));
  std::vector<SlicePlane> slices;
  for (int k = 0; k < count; ++k) {
    SlicePlane slice;
    slice.name = "slice " + std::to_string(k);
    slice.p_SV = p_first + turn.col(2) * (gap * k);
    slice.along_row = turn.col(0);
    slice.along_column = turn.col(1);
    slice.spacing_i_mm = 0.5;
    slice.spacing_j_mm = 0.75;
    slice.columns = 32;
    slice.rows = 16;
    slices.push_back(slice);
  }
  return slices;
}

std::string refusal_of_slices(const std::vector<SlicePlane>& slices) {
  try {
    stack_slices(slices);
  } catch (const ConfigError& refusal) {
    return refusal.what();
  }
  return "accepted";
}

TEST(StackSlabs, MakesOneStackForEachOrientationFromASingleSliceOn) {
  std::mt19937 random(5);
  std::vector<SlicePlane> slices;
  for (const int count : {1, 3, 2})
    for (SlicePlane slice : random_stack(random, count, 4.0)) {
      slice.thickness_mm = 3.5;
      slices.push_back(slice);
    }
  const std::vector<SliceStack> stacks = stack_slabs(slices);
  ASSERT_EQ(stacks.size(), 3u);
  EXPECT_EQ(stacks[0].grid.size.z(), 1);
  EXPECT_NEAR(stacks[0].grid.spacing_mm().z(), 3.5, 1e-9);
  EXPECT_EQ(stacks[1].grid.size.z(), 3);
  EXPECT_NEAR(stacks[1].grid.spacing_mm().z(), 4.0, 1e-9);
  EXPECT_EQ(stacks[2].order, (std::vector<std::size_t>{4, 5}));
  for (const SliceStack& stack : stacks)
    EXPECT_LT((stack.grid.X_SI.translation() - slices[stack.order.front()].p_SV).norm(), 1e-9);
}

TEST(StackSlabs, RefusesASingleSliceOfUnknownThickness) {
  std::mt19937 random(6);
  EXPECT_THROW(stack_slabs(random_stack(random, 1, 4.0)), ConfigError);
}

TEST(StackGeometry, IsTheSameHoweverTheFilesAreOrdered) {
  std::mt19937 random(1);
  for (int n = 0; n < 50; ++n) {
    std::vector<SlicePlane> slices = random_stack(random, 9, 2.7);
    const SliceStack in_order = stack_slices(slices);
    std::shuffle(slices.begin(), slices.end(), random);
    const SliceStack shuffled = stack_slices(slices);
    EXPECT_TRUE(in_order.grid.X_SI.isApprox(shuffled.grid.X_SI, 1e-12));
    for (int k = 0; k < 9; ++k) {
      const SlicePlane& slice = slices[shuffled.order[static_cast<std::size_t>(k)]];
      EXPECT_EQ(slice.name, "slice " + std::to_string(k));
      EXPECT_LT((shuffled.grid.X_SI * Point(0, 0, k) - slice.p_SV).norm(), 1e-9);
      const Point far_corner = slice.p_SV + slice.along_row * (31 * 0.5) + slice.along_column * (15 * 0.75);
      EXPECT_LT((shuffled.grid.X_SI * Point(31, 15, k) - far_corner).norm(), 1e-9);
    }
  }
}

TEST(StackGeometry, FindsEveryMissingInnerSlice) {
  std::mt19937 random(2);
  for (int missing = 1; missing < 8; ++missing) {
    std::vector<SlicePlane> slices = random_stack(random, 9, 2.7);
    slices.erase(slices.begin() + missing);
    const std::string said = refusal_of_slices(slices);
    EXPECT_NE(said.find("slice " + std::to_string(missing - 1) + " and slice " + std::to_string(missing + 1)),
              std::string::npos)
        << said;
  }
}

TEST(StackGeometry, ToleratesRoundingButNotHalfTheRobotsError) {
  std::mt19937 random(3);
  std::vector<SlicePlane> slices = random_stack(random, 9, 2.7);
  const Direction normal = slices[0].along_row.cross(slices[0].along_column);
  for (const Direction& way : {normal, slices[0].along_row}) {
    std::vector<SlicePlane> moved = slices;
    moved[4].p_SV += 0.01 * way;
    EXPECT_EQ(refusal_of_slices(moved), "accepted");
    moved[4].p_SV += 0.05 * way;
    EXPECT_NE(refusal_of_slices(moved), "accepted");
  }
}

// Each gap is within tolerance of its neighbours, the sum is not.
TEST(StackGeometry, RefusesSpacingThatCreeps) {
  std::mt19937 random(4);
  std::vector<SlicePlane> slices = random_stack(random, 40, 2.7);
  const Direction normal = slices[0].along_row.cross(slices[0].along_column);
  for (std::size_t k = 0; k < slices.size(); ++k)
    slices[k].p_SV += normal * (0.001 * static_cast<double>(k * k));
  EXPECT_NE(refusal_of_slices(slices).find("uneven"), std::string::npos) << refusal_of_slices(slices);
}

TEST(StackGeometry, RefusesPlacesThatAreNoPlaces) {
  std::mt19937 random(5);
  std::vector<SlicePlane> slices = random_stack(random, 5, 2.7);
  slices[2].p_SV.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal_of_slices(slices).find("slice 2: position or orientation is not finite"),
            std::string::npos);
  slices = random_stack(random, 5, 2.7);
  for (SlicePlane& slice : slices) slice.p_SV.x() += 20'000.0;
  EXPECT_NE(refusal_of_slices(slices).find("10 m"), std::string::npos);
  EXPECT_NE(refusal_of_slices(random_stack(random, 5, 101.0)).find("spacing"), std::string::npos);
  EXPECT_NE(refusal_of_slices({}), "accepted");
}

}  // namespace
}  // namespace biopsy::imaging
