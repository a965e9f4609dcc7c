#include "planner/plan/registration.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "robot/common/config_error.hpp"

namespace biopsy::planner {
namespace {

using Points = Eigen::Matrix3Xd;  // one column a point

Points points_of(const std::vector<FiducialPair>& pairs, Point FiducialPair::*frame) {
  Points points(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t n = 0; n < pairs.size(); ++n) points.col(static_cast<Eigen::Index>(n)) = pairs[n].*frame;
  return points;
}

// Principal axes of a cloud: columns of `axes`, and the variance along each, rising.
struct PrincipalAxes {
  Point centre;
  Eigen::Matrix3d axes;
  Eigen::Vector3d variance;
};

PrincipalAxes principal_axes(const Points& points) {
  const Point centre = points.rowwise().mean();
  const Points about_centre = points.colwise() - centre;
  const Eigen::Matrix3d covariance =
      about_centre * about_centre.transpose() / static_cast<double>(points.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return {centre, solver.eigenvectors(), solver.eigenvalues().cwiseMax(0.0)};
}

// Extent in the second widest direction: zero for points on a line.
double spread_mm(const Points& points) {
  return std::sqrt(principal_axes(points).variance(1));
}

RigidTransform least_squares(const Points& robot, const Points& scanner) {
  const Point robot_centre = robot.rowwise().mean(), scanner_centre = scanner.rowwise().mean();
  const Eigen::Matrix3d correlation =
      (robot.colwise() - robot_centre) * (scanner.colwise() - scanner_centre).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // A reflection may fit better than any rotation, but the robot is not mirrored.
  const double handedness = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  RigidTransform X_SR = RigidTransform::Identity();
  X_SR.linear() =
      svd.matrixV() * Eigen::Vector3d(1.0, 1.0, handedness).asDiagonal() * svd.matrixU().transpose();
  X_SR.translation() = scanner_centre - X_SR.linear() * robot_centre;
  return X_SR;
}

PlanRefusal collinear(const char* frame, double spread) {
  return {fmt::format(
              "the fiducials lie nearly on one line in the {} frame: they extend {:.1f} mm (rms) across it, "
              "{:.0f} mm are needed to fix the rotation",
              frame, spread, kSpreadMin_mm),
          "add a fiducial well away from that line; if the numbers are metres or centimetres, convert them "
          "to mm"};
}

}  // namespace

std::variant<Registration, PlanRefusal> register_robot(const std::vector<FiducialPair>& pairs) {
  if (pairs.size() < 3)
    return PlanRefusal{fmt::format("{} fiducial pairs; a rigid registration needs at least 3", pairs.size()),
                       "measure more fiducials in both frames, four or more around the needle"};
  const Points robot = points_of(pairs, &FiducialPair::p_RF), scanner = points_of(pairs, &FiducialPair::p_SF);
  if (!robot.allFinite() || !scanner.allFinite())
    return PlanRefusal{"a fiducial has a coordinate that is not a number", "measure it again"};
  if (const double spread = spread_mm(robot); spread < kSpreadMin_mm) return collinear("robot", spread);
  if (const double spread = spread_mm(scanner); spread < kSpreadMin_mm) return collinear("scanner", spread);

  Registration result{
      .X_SR = least_squares(robot, scanner), .fre_mm = 0.0, .residual_mm = {}, .pairs = pairs};
  const Eigen::VectorXd residual = (result.X_SR * robot - scanner).colwise().norm();
  result.residual_mm.assign(residual.begin(), residual.end());
  result.fre_mm = std::sqrt(residual.squaredNorm() / static_cast<double>(pairs.size()));
  if (result.fre_mm > kFreLimit_mm) {
    const auto worst = std::max_element(result.residual_mm.begin(), result.residual_mm.end());
    return PlanRefusal{
        fmt::format("fiducial registration error {:.2f} mm is above the limit of {:.2f} mm", result.fre_mm,
                    kFreLimit_mm),
        fmt::format(
            "check fiducial {}, which is off by {:.2f} mm: measure it again, or see whether two were swapped",
            pairs[static_cast<std::size_t>(worst - result.residual_mm.begin())].name, *worst)};
  }
  return result;
}

double expected_tre_mm(const Registration& registration, const Point& p_ST) {
  const auto count = static_cast<double>(registration.pairs.size());
  assert(count >= 3);
  const PrincipalAxes cloud = principal_axes(points_of(registration.pairs, &FiducialPair::p_SF));
  const Eigen::Vector3d along = cloud.axes.transpose() * (p_ST - cloud.centre);
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double target_squared = along.squaredNorm() - along(k) * along(k);    // d_k^2
    const double fiducials_squared = cloud.variance.sum() - cloud.variance(k);  // f_k^2
    sum += target_squared / fiducials_squared;
  }
  const double fle_squared = registration.fre_mm * registration.fre_mm * count / (count - 2.0);
  return std::sqrt(fle_squared / count * (1.0 + sum / 3.0));
}

RigidTransform rigid_transform_from_ras(const std::array<double, 16>& rows, const std::string& where) {
  constexpr double kTolerance = 1e-4;  // four digits of a rotation typed by hand
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.data());
  const auto refuse = [&where](const std::string& what) {
    throw ConfigError(what, where,
                      "give the 4 x 4 robot-to-scanner transform row by row: rotation, translation in mm "
                      "(RAS), and 0 0 0 1");
  };
  if (!matrix.allFinite()) refuse("the transform has an entry that is not a number");
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kTolerance))
    refuse("the last row of the transform is not 0 0 0 1 (is it written column by column?)");
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  if (!(rotation * rotation.transpose()).isIdentity(kTolerance)) refuse("the transform stretches or shears");
  if (rotation.determinant() < 0.0) refuse("the transform mirrors (determinant -1)");

  const Eigen::Vector3d lps_sign(-1.0, -1.0, 1.0);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  RigidTransform X_SR = RigidTransform::Identity();
  X_SR.linear() =
      lps_sign.asDiagonal() * (svd.matrixU() * svd.matrixV().transpose());  // nearest true rotation
  X_SR.translation() = lps_from_ras(matrix.topRightCorner<3, 1>());
  return X_SR;
}

RigidTransform needle_pose(const Point& p_SE, const Point& p_ST) {
  const Eigen::Vector3d path = p_ST - p_SE;
  if (!(path.norm() > 0.01))
    throw ConfigError("entry and target are the same point", "needle path",
                      "choose a target deeper than the entry");
  RigidTransform X_SR = RigidTransform::Identity();
  X_SR.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), path).toRotationMatrix();
  X_SR.translation() = p_SE;
  return X_SR;
}

}  // namespace biopsy::planner
