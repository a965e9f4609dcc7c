#include "planner/plan/layers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "robot/common/config_error.hpp"

namespace biopsy::planner {
namespace {

const LabelNames kNames = {{1, "muscle"}, {2, "gap"}, {3, "liver"}};

// A label volume whose voxel (i, j, k) has label_of(i, j, k).
Volume labelled(const Eigen::Vector3i& size, const AffineTransform& X_SI,
                const std::function<int(int, int, int)>& label_of) {
  Volume volume;
  volume.grid = {size, X_SI};
  volume.files = {"labels.nii.gz"};
  volume.voxels.resize(volume.grid.voxel_count());
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i)
        volume.voxels[volume.grid.index(i, j, k)] = static_cast<float>(label_of(i, j, k));
  return volume;
}

// An oblique, anisotropic grid: voxels of 1.2 x 0.9 x 0.5 mm, turned and shifted.
AffineTransform oblique_grid() {
  AffineTransform X_SI = AffineTransform::Identity();
  X_SI.linear() = Eigen::AngleAxisd(0.7, Point(1, 2, 3).normalized()).toRotationMatrix() *
                  Eigen::Vector3d(1.2, 0.9, 0.5).asDiagonal();
  X_SI.translation() = Point(-30, 12, 55);
  return X_SI;
}

AffineTransform isotropic_grid(double spacing) {
  AffineTransform X_SI = AffineTransform::Identity();
  X_SI.linear() *= spacing;
  return X_SI;
}

TEST(Layers, BoundariesOfAnObliquePathThroughSlabsAreWhereGeometrySays) {
  const AffineTransform X_SI = oblique_grid();
  const Volume volume = labelled({40, 40, 40}, X_SI, [](int, int, int k) {
    return k <= 10 ? 1 : k <= 13 ? 2 : 3;
  });
  const Point p_IE(20, 18, 6.2);
  const Direction axis_S = (X_SI.linear() * Point(2, -1.5, 5)).normalized();
  const double k_per_mm = (X_SI.linear().inverse() * axis_S).z();
  const auto layers = layers_along_path(volume, X_SI * p_IE, axis_S, Millimetres(6.0), kNames);
  ASSERT_EQ(layers.size(), 3u);
  EXPECT_EQ(layers[0].name + layers[1].name + layers[2].name, "musclegapliver");
  EXPECT_EQ(layers[0].from.value, 0.0);
  EXPECT_NEAR(layers[0].to.value, (10.5 - 6.2) / k_per_mm, 1e-3);  // the face between voxels 10 and 11
  EXPECT_NEAR(layers[1].to.value, (13.5 - 6.2) / k_per_mm, 1e-3);
  EXPECT_EQ(layers[2].to.value, 6.0);
  EXPECT_EQ(layer_fault(layers), "");
}

TEST(Layers, ChordThroughABallAgreesWithinAVoxel) {
  const double spacing = 0.25, radius = 4.0;
  const Point centre(10, 10, 10);
  const Volume volume = labelled({80, 80, 80}, isotropic_grid(spacing), [&](int i, int j, int k) {
    return (spacing * Point(i, j, k) - centre).norm() <= radius ? 3 : 1;
  });
  for (const double beside : {0.0, 1.5, 2.5}) {
    const Direction axis = Point(1, 0.3, 0.2).normalized();
    const Point sideways = axis.cross(Point(0, 0, 1)).normalized();
    const auto layers =
        layers_along_path(volume, centre + beside * sideways - 6.0 * axis, axis, Millimetres(12.0), kNames);
    const double half_chord = std::sqrt(radius * radius - beside * beside);
    ASSERT_EQ(layers.size(), 3u) << beside;
    EXPECT_NEAR(layers[1].from.value, 6.0 - half_chord, 2.0 * spacing);
    EXPECT_NEAR(layers[1].to.value, 6.0 + half_chord, 2.0 * spacing);
  }
}

TEST(Layers, SliversOfTheGridGoToTheirNeighbours) {
  // The path y = x - 1.4 clips a corner of voxel (6, 4), from (5.5, 4.1) to (5.9, 4.5): 0.57 mm of the 1.41
  // mm that a diagonal path spends in a voxel.
  const auto corner = [](int label) {
    return labelled({14, 12, 3}, isotropic_grid(1.0), [label](int i, int j, int) {
      return i == 6 && j == 4 ? 2 : i + j < 11 ? 1 : label;
    });
  };
  const auto along = [](const Volume& volume) {
    return layers_along_path(volume, Point(1.5, 0.1, 1), Point(1, 1, 0).normalized(), Millimetres(12.0),
                             kNames);
  };
  const auto same = along(corner(1));
  ASSERT_EQ(same.size(), 1u);
  EXPECT_EQ(same[0].name, "muscle");
  // Between two tissues the sliver is divided: from x = 5.5 to 5.9 its middle is 4.2 sqrt(2) from the start.
  const auto different = along(corner(3));
  ASSERT_EQ(different.size(), 2u);
  EXPECT_EQ(different[0].name + different[1].name, "muscleliver");
  EXPECT_NEAR(different[1].from.value, 4.2 * std::sqrt(2.0), 2e-3);
}

TEST(Layers, ALayerOfAWholeVoxelIsKept) {
  const Volume volume = labelled({12, 3, 3}, isotropic_grid(0.9), [](int i, int, int) {
    return i < 3 ? 1 : i == 3 ? 2 : 3;
  });
  const auto layers =
      layers_along_path(volume, Point(0.45, 0.9, 0.9), Point(1, 0, 0), Millimetres(8.0), kNames);
  ASSERT_EQ(layers.size(), 3u);
  EXPECT_NEAR(layers[1].from.value, 1.8, 1e-3);
  EXPECT_NEAR(layers[1].thickness().value, 0.9, 2e-3);
}

TEST(Layers, LabelsWithoutANameAreNumbered) {
  const Volume volume =
      labelled({4, 3, 12}, isotropic_grid(1.0), [](int, int, int k) { return k < 6 ? 0 : 7; });
  const auto layers = layers_along_path(volume, Point(1, 1, 1), Point(0, 0, 1), Millimetres(9.0), kNames);
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0].name, "unlabelled");
  EXPECT_EQ(layers[1].name, "label 7");
}

TEST(Layers, RefusesAPathOutsideTheLabelMapNamingTheFile) {
  const Volume volume = labelled({10, 10, 10}, isotropic_grid(1.0), [](int, int, int) { return 1; });
  try {
    layers_along_path(volume, Point(5, 5, 5), Point(0, 0, 1), Millimetres(6.0), kNames);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(error.what_is_wrong.find("leaves the label map 4.5 mm"), std::string::npos)
        << error.what_is_wrong;
    EXPECT_EQ(error.where, "labels.nii.gz");
  }
  EXPECT_THROW(layers_along_path(volume, Point(-1, 5, 5), Point(0, 0, 1), Millimetres(2.0), kNames),
               ConfigError);
}

TEST(Layers, RefusesAnImageInPlaceOfLabels) {
  Volume volume = labelled({10, 10, 10}, isotropic_grid(1.0), [](int, int, int) { return 1; });
  for (float& voxel : volume.voxels) voxel = 103.7F;
  EXPECT_THROW(layers_along_path(volume, Point(5, 5, 2), Point(0, 0, 1), Millimetres(2.0), kNames),
               ConfigError);
  for (float& voxel : volume.voxels) voxel = std::nanf("");
  EXPECT_THROW(layers_along_path(volume, Point(5, 5, 2), Point(0, 0, 1), Millimetres(2.0), kNames),
               ConfigError);
}

Layer layer(const char* name, double from, double to) {
  return {name, Millimetres(from), Millimetres(to)};
}

TEST(LayerTable, AcceptsThePapersPhantom) {
  EXPECT_EQ(layer_fault({layer("muscle", 0, 2), layer("gap", 2, 2.9), layer("liver", 2.9, 20)}), "");
}

TEST(LayerTable, RefusesWhatDoesNotDescribeAPath) {
  const std::vector<std::vector<Layer>> faulty = {{},
                                                  {layer("muscle", 0.1, 2)},
                                                  {layer("muscle", 0, 2), layer("gap", 2.1, 3)},
                                                  {layer("muscle", 0, 2), layer("gap", 1.9, 3)},
                                                  {layer("muscle", 0, 0)},
                                                  {layer("muscle", 0, 2), layer("gap", 2, 1)},
                                                  {layer("", 0, 2)},
                                                  {layer("muscle", 0, std::nan(""))},
                                                  {layer("muscle", 0, INFINITY)}};
  for (const auto& layers : faulty) {
    EXPECT_NE(layer_fault(layers), "");
    EXPECT_THROW(check_layers(layers, "case.toml"), ConfigError);
  }
}

}  // namespace
}  // namespace biopsy::planner
