// The field of a needle against solutions in closed form: sphere, endless cylinder, ends of a thin rod.
// Inputs: these formulae (Jackson, Classical Electrodynamics, 5.10 and 5.11), computed here.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robot/common/config_error.hpp"
#include "sim/scanner/susceptibility/dipole_convolution.hpp"
#include "sim/scanner/susceptibility/needle_field.hpp"

namespace biopsy::sim {
namespace {

constexpr double kTurn = std::numbers::pi / 180.0;

TEST(DipoleConvolution, GivesTheFieldOfASphere) {
  const int n = 24;
  const double radius = 5.0;
  Lattice sphere(Eigen::Vector3i::Constant(n));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        int inside = 0;
        for (int m = 0; m < 512; ++m)
          inside += (Eigen::Vector3d(i + (m & 7) / 8.0, j + ((m >> 3) & 7) / 8.0, k + (m >> 6) / 8.0) +
                     Eigen::Vector3d::Constant(1.0 / 16 - 0.5 * n))
                        .norm() < radius;
        sphere.at({i, j, k}) = static_cast<float>(inside / 512.0);
      }
  for (const Direction& b0 : {Direction(0, 0, 1), Direction(0.6, 0.0, 0.8)}) {
    const Eigen::Vector3i size(40, 36, 32), offset(-8, -6, -4);
    const Lattice field = dipole_field(sphere, b0, size, offset);
    double at_surface = 0.0, away = 0.0;  // worst errors, one and two cells off the surface and beyond
    for (int k = 0; k < size.z(); ++k)
      for (int j = 0; j < size.y(); ++j)
        for (int i = 0; i < size.x(); ++i) {
          const Eigen::Vector3d r =
              (Eigen::Vector3i(i, j, k) + offset).cast<double>() + Eigen::Vector3d::Constant(0.5 - 0.5 * n);
          const double value = static_cast<double>(field.at({i, j, k}));
          if (r.norm() < radius - 2.0) {
            EXPECT_LT(std::abs(value), 0.01);
          }
          if (r.norm() < radius + 1.0) continue;
          const double cosine = r.normalized().dot(b0);
          const double exact = std::pow(radius / r.norm(), 3) * (3.0 * cosine * cosine - 1.0) / 3.0;
          double& worst = r.norm() < radius + 2.0 ? at_surface : away;
          worst = std::max(worst, std::abs(value - exact));
        }
    EXPECT_LT(at_surface, 0.015);  // of 0.67 at the poles, with five cells to a radius
    EXPECT_LT(away, 0.004);
  }
}

NeedleBody titanium(const Direction& axis) {
  NeedleBody needle;
  needle.p_SE = Point(10.0, -20.0, 30.0);
  needle.p_ST = needle.p_SE + 40.0 * axis.normalized();
  needle.diameter = Millimetres(1.2);
  return needle;
}

TEST(NeedleField, IsThatOfAnEndlessCylinderAlongTheShaft) {
  for (double angle : {90.0, 60.0, 20.0, 0.0}) {
    const NeedleBody needle = titanium({std::sin(angle * kTurn), 0.0, std::cos(angle * kTurn)});
    const NeedleField field(needle, Direction::UnitZ());
    const Direction across = Direction::UnitY(), up = needle.axis_S().cross(across);
    for (double behind : {3.0, 10.0, 40.0})  // in and beyond the lattice, of 6 mm
      for (double r : {1.0, 1.5, 4.0})
        for (double phi : {0.0, 30.0, 45.0, 90.0}) {
          if (behind < 3.0 * r) continue;  // the tip is far enough away
          const Point p = needle.p_ST - behind * needle.axis_S() +
                          r * (std::cos(phi * kTurn) * up + std::sin(phi * kTurn) * across);
          const double sine = std::sin(angle * kTurn);
          const double exact =
              needle.contrast() / 2.0 * std::pow(0.6 / r, 2) * sine * sine * std::cos(2.0 * phi * kTurn);
          // What the ends add is at most the fields of poles.
          const double poles =
              needle.contrast() / 4.0 *
              (std::pow(0.6 / (behind - 4.0 / 3.0), 2) + std::pow(0.6 / (150.0 - behind), 2));
          EXPECT_NEAR(field.at(p), exact, 0.03 * std::abs(exact) + 1.05 * poles)
              << angle << " " << behind << " " << r;
        }
  }
}

// A rod along the field: a disc of poles at its end, chi/2 (1 - z / sqrt(z^2 + a^2)) before it on the axis.
TEST(NeedleField, HasThePoleOfItsEndWhereTheShaftLiesAlongTheField) {
  NeedleBody needle = titanium(Direction::UnitZ());
  needle.tip_length = Millimetres(0.0);
  const NeedleField field(needle, Direction::UnitZ());
  for (double ahead : {0.6, 1.0, 2.0, 4.0, 5.9, 6.1, 9.0, 15.0}) {
    const double exact = needle.contrast() / 2.0 * (1.0 - ahead / std::hypot(ahead, 0.6));
    EXPECT_NEAR(field.at(needle.p_ST + Point(0, 0, ahead)), exact, 0.04 * exact) << ahead;
  }
  // Beside the shaft, far from the ends, nothing is left.
  EXPECT_LT(std::abs(field.at(needle.p_ST + Point(2.0, 0.0, -30.0))), 1e-3 * needle.contrast());
}

TEST(NeedleField, IsContinuousWhereTheLatticeEnds) {
  for (double angle : {0.0, 35.0, 90.0})
    for (double tip : {0.0, 3.0}) {
      NeedleBody needle = titanium({std::sin(angle * kTurn), 0.0, std::cos(angle * kTurn)});
      needle.tip_length = Millimetres(tip);
      const NeedleField field(needle, Direction::UnitZ());
      const Direction n = needle.axis_S(), across = Direction::UnitY(), up = n.cross(across);
      const double face = 10.0 * 0.6 - 0.5 * 0.15;
      for (const Point& p : {Point(face * n), Point(face * up), Point(face * across),
                             Point(face * (n + up) + across), Point(-face * n + 1.0 * up)}) {
        const Point inner = needle.p_ST + p * (1.0 - 1e-6), outer = needle.p_ST + p * (1.0 + 1e-6);
        const double value = field.at(outer);
        EXPECT_NEAR(field.at(inner), value, 0.02 * std::abs(value) + 5e-4 * needle.contrast())
            << angle << " " << tip;
      }
    }
}

// It turns with the needle and the field, grows with the size and the contrast: nothing depends on the axes.
TEST(NeedleField, DependsOnTheAnglesBetweenNeedleFieldAndPointAlone) {
  const NeedleBody needle = titanium({0.5, 0.2, 0.8});
  const NeedleField field(needle, Direction::UnitZ());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Direction(1, 2, -1).normalized()).toRotationMatrix();
  NeedleBody turned = needle;
  turned.p_SE = turn * needle.p_SE, turned.p_ST = turn * needle.p_ST;
  NeedleBody doubled = needle;
  doubled.p_SE = 2.0 * needle.p_SE, doubled.p_ST = 2.0 * needle.p_ST,
  doubled.diameter = 2.0 * needle.diameter;
  doubled.tip_length = 2.0 * needle.tip_length, doubled.shaft_length = 2.0 * needle.shaft_length;
  const NeedleField other(turned, turn * Direction::UnitZ()), larger(doubled, -Direction::UnitZ());
  for (const Point& d : {Point(1, 1, 1), Point(0, -2, 3), Point(6, 1, -4), Point(-3, 9, 2)}) {
    const double value = field.at(needle.p_ST + d);
    EXPECT_NEAR(other.at(turn * (needle.p_ST + d)), value, 0.02 * std::abs(value) + 2e-5 * needle.contrast());
    EXPECT_NEAR(larger.at(2.0 * (needle.p_ST + d)), value, 1e-3 * std::abs(value) + 1e-9);
  }
}

TEST(NeedleField, RefusesWhatIsNoNeedle) {
  NeedleBody needle;
  needle.p_ST = needle.p_SE;
  EXPECT_THROW(NeedleField(needle, Direction::UnitZ()), ConfigError);
  needle = NeedleBody{};
  needle.diameter = Millimetres(12.0);
  EXPECT_THROW(NeedleField(needle, Direction::UnitZ()), ConfigError);
  EXPECT_THROW(NeedleField(NeedleBody{}, Direction::Zero()), ConfigError);
  EXPECT_THROW(needle_material("wood"), ConfigError);
  EXPECT_NEAR(needle_material("titanium").susceptibility_ppm, 182.0, 1.0);
}

}  // namespace
}  // namespace biopsy::sim
