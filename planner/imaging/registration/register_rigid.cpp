#include "planner/imaging/registration/register_rigid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "planner/imaging/registration/local_contrast.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::imaging {
namespace {

constexpr int kThin = 5;  // slices

bool is_thin(const Volume& volume) {
  return volume.grid.size.z() <= kThin;
}

using Vector14 = Eigen::Matrix<double, 14, 1>;
using Matrix14 = Eigen::Matrix<double, 14, 14>;

constexpr double kTurn_rad = 0.05, kMove_mm = 5.0;  // of a patient, one standard deviation
constexpr double kAlike = 30.0;                     // places that err together: so many count as one
constexpr double kLever_mm = 50.0;                  // at which a rotation is counted as a distance
constexpr double kStepMost_mm = 4.0;                // in one iteration
constexpr double kDegrees = 180.0 / std::numbers::pi;

// The motion that is searched takes a place in the after image to its place in the before image.
struct Motion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();

  Point apply(const Point& p, const Point& about) const { return rotation * (p - about) + about + shift; }
};

struct Place {
  Point p_S;
  Eigen::Vector4d x;  // 1 and box coordinates
  double value;       // of the after image
};

// A lattice in the box; for a stack of few slices, which a lattice would miss, one in each of its slices.
void add_places(const Volume& after, const RegistrationSettings& s, double count,
                std::vector<Place>& places) {
  const Sampler sampler(after);
  const Eigen::Vector3d half = (0.5 * (s.box.high - s.box.low)).cwiseMax(1e-6);
  const auto add = [&](const Point& p_S) {
    if (!s.box.contains(p_S) || (s.mask && s.mask->covers(p_S))) return;
    const double value = sampler.at(p_S);
    if (std::isnan(value)) return;
    const Eigen::Vector3d x = (p_S - s.box.centre()).cwiseQuotient(half);
    places.push_back({p_S, {1.0, x.x(), x.y(), x.z()}, value});
  };
  if (is_thin(after)) {
    const Eigen::Vector3d sides = after.grid.size.cast<double>().cwiseProduct(after.grid.spacing_mm());
    const double step_mm = std::sqrt(sides.x() * sides.y() * after.grid.size.z() / count);
    const Eigen::Vector3d step = (step_mm / after.grid.spacing_mm().array()).max(1.0);
    for (int k = 0; k < after.grid.size.z(); ++k)
      for (double j = 0.0; j < after.grid.size.y(); j += step.y())
        for (double i = 0.0; i < after.grid.size.x(); i += step.x())
          add(after.grid.X_SI * Eigen::Vector3d(i, j, k));
    return;
  }
  const double step_mm = std::cbrt((2.0 * half).prod() / count);
  const Eigen::Vector3i steps = (2.0 * half / step_mm).array().floor().cast<int>();
  for (int k = 0; k <= steps.z(); ++k)
    for (int j = 0; j <= steps.y(); ++j)
      for (int i = 0; i <= steps.x(); ++i) add(s.box.low + step_mm * Eigen::Vector3d(i, j, k));
}

std::vector<Place> places_to_compare(const std::vector<Volume>& after, const RegistrationSettings& s,
                                     double count) {
  std::vector<Place> places;
  for (const Volume& stack : after) add_places(stack, s, count / static_cast<double>(after.size()), places);
  return places;
}

// Sums over pairs of values (a of the after image, b of the before image).
struct Moments {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double after, double before) {
    n += 1, a += after, b += before;
    aa += after * after, bb += before * before, ab += after * before;
  }
  double covariance() const { return ab - a * b / n; }  // times n
  double correlation() const {
    const double variance = n > 0 ? (aa - a * a / n) * (bb - b * b / n) : 0.0;
    return variance > 0.0 ? covariance() / std::sqrt(variance) : -1.0;
  }
};

struct Fit {
  Motion motion;
  Eigen::Vector4d gain = Eigen::Vector4d(1, 0, 0, 0), bias = Eigen::Vector4d::Zero();
  double score = -1.0;  // correlation of after with gain * before + bias
  std::size_t used = 0;
};

// One image pair at one scale.
class Level {
 public:
  Level(const Volume& before, const std::vector<Volume>& after, const RegistrationSettings& settings,
        double count)
      : before_(before), places_(places_to_compare(after, settings, count)), about_(settings.about) {
    // What the before image could not show of a patient who lay still counts as no lack of overlap.
    std::erase_if(places_, [&](const Place& place) { return std::isnan(before_.at(place.p_S)); });
  }

  const std::vector<Place>& places() const { return places_; }
  // -1 where less than half of the places overlap.
  double correlation_at(const Motion& motion) const {
    const Moments sums = moments(motion, [](const Place&, double value) { return value; });
    return covers_half(sums) && sums.n >= 50 ? sums.correlation() : -1.0;
  }

  // Gauss-Newton until a step moves nothing by more than a thousandth of a millimetre.
  Fit refined(const Motion& start, int iterations) const {
    Fit fit;
    fit.motion = start;
    fit_brightness(fit);
    for (int i = 0; i < iterations; ++i) {
      Vector14 step = gauss_newton_step(fit);
      if (!step.allFinite()) break;
      // From afar the linear model holds for a few millimetres only.
      const double moved_mm = step.head<3>().norm() * kLever_mm + step.segment<3>(3).norm();
      step *= std::min(1.0, kStepMost_mm / std::max(moved_mm, 1e-9));
      const Eigen::Vector3d turn = step.head<3>();
      if (turn.norm() > 0.0)
        fit.motion.rotation =
            Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * fit.motion.rotation;
      fit.motion.shift += step.segment<3>(3);
      fit.gain += step.segment<4>(6);
      fit.bias += step.tail<4>();
      if (moved_mm < 1e-3) break;
    }
    score(fit);
    return fit;
  }
  // One gain and one bias.
  Fit matched(const Motion& motion) const {
    Fit fit;
    fit.motion = motion;
    fit_brightness(fit);
    return fit;
  }

 private:
  // Of the after image and `model` of the before image's value, where both are known.
  template <class Model>
  Moments moments(const Motion& motion, const Model& model) const {
    Moments sums;
    for (const Place& place : places_) {
      const double value = before_.at(motion.apply(place.p_S, about_));
      if (!std::isnan(value)) sums.add(place.value, model(place, value));
    }
    return sums;
  }
  bool covers_half(const Moments& sums) const { return sums.n >= 0.5 * static_cast<double>(places_.size()); }

  void fit_brightness(Fit& fit) const {
    const Moments sums = moments(fit.motion, [](const Place&, double value) { return value; });
    const double variance = sums.bb - sums.b * sums.b / std::max(sums.n, 1.0);
    fit.gain[0] = variance > 0.0 ? std::max(sums.covariance() / variance, 0.05) : 1.0;
    fit.bias[0] = sums.n > 0 ? (sums.a - fit.gain[0] * sums.b) / sums.n : 0.0;
  }

  Vector14 gauss_newton_step(const Fit& fit) const {
    std::vector<double> sizes;
    sizes.reserve(places_.size());
    for (const Place& place : places_) {
      const double value = before_.at(fit.motion.apply(place.p_S, about_));
      if (!std::isnan(value))
        sizes.push_back(std::abs(place.value - fit.gain.dot(place.x) * value - fit.bias.dot(place.x)));
    }
    if (sizes.size() < 100) return Vector14::Constant(std::nan(""));
    // Tukey's biweight at 95 % efficiency
    const double limit = std::max(4.685 * kMadToSigma * median(std::move(sizes)), 1e-9);

    Matrix14 normal = Matrix14::Zero();
    Vector14 right = Vector14::Zero();
    for (const Place& place : places_) {
      const Eigen::Vector3d y = fit.motion.rotation * (place.p_S - about_);
      double value;
      Eigen::Vector3d gradient;
      if (!before_.at(y + about_ + fit.motion.shift, value, gradient)) continue;
      const double gain = fit.gain.dot(place.x);
      const double error = place.value - gain * value - fit.bias.dot(place.x);
      if (std::abs(error) >= limit) continue;
      const double weight = std::pow(1.0 - std::pow(error / limit, 2), 2);
      Vector14 row;
      row << gain * y.cross(gradient), gain * gradient, value * place.x, place.x;
      normal.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
      right += weight * error * row;
    }
    normal = normal.selfadjointView<Eigen::Lower>();
    // What images do not tell is not made up: most patients move by little.
    const double alike = kAlike * std::pow(limit / 4.685, 2);
    const double turns = alike / std::pow(kTurn_rad, 2), moves_by = alike / std::pow(kMove_mm, 2);
    const Eigen::AngleAxisd turn(fit.motion.rotation);
    normal.diagonal().head<3>().array() += turns;
    right.head<3>() -= turns * turn.angle() * turn.axis();
    normal.diagonal().segment<3>(3).array() += moves_by;
    right.segment<3>(3) -= moves_by * fit.motion.shift;
    normal.diagonal() *= 1.0 + 1e-4;  // flat images leave some motions free: those then stay put
    normal.diagonal().array() += 1e-12 * normal.diagonal().maxCoeff();
    return normal.ldlt().solve(right);
  }

  void score(Fit& fit) const {
    const Moments sums = moments(fit.motion, [&](const Place& place, double value) {
      return fit.gain.dot(place.x) * value + fit.bias.dot(place.x);
    });
    fit.used = static_cast<std::size_t>(sums.n);
    fit.score = covers_half(sums) && sums.n >= 100 ? sums.correlation() : -1.0;
  }

  Sampler before_;
  std::vector<Place> places_;
  Point about_;
};

std::vector<Motion> starts(const Level& level, double reach_mm) {
  struct Scored {
    Motion motion;
    double score;
  };
  std::vector<Scored> all;
  const int n = 2;
  for (int k = -n; k <= n; ++k)
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        Motion motion;
        motion.shift = Eigen::Vector3d(i, j, k) * (reach_mm / n);
        all.push_back({motion, level.correlation_at(motion)});
      }
  std::stable_sort(all.begin(), all.end(),
                   [](const Scored& a, const Scored& b) { return a.score > b.score; });
  std::vector<Motion> best{Motion{}};  // lying still is always worth a try
  for (std::size_t i = 0; i < 3 && i < all.size(); ++i) best.push_back(all[i].motion);
  return best;
}

// Mean distance between where two motions put the corners of the box.
double distance_mm(const Motion& a, const Motion& b, const RegistrationSettings& s) {
  double sum = 0.0;
  for (int n = 0; n < 8; ++n) {
    const Point corner((n & 1) ? s.box.high.x() : s.box.low.x(), (n & 2) ? s.box.high.y() : s.box.low.y(),
                       (n & 4) ? s.box.high.z() : s.box.low.z());
    sum += (a.apply(corner, s.about) - b.apply(corner, s.about)).norm();
  }
  return sum / 8.0;
}

RegistrationResult finished(const Fit& fit, const RegistrationSettings& s) {
  RegistrationResult result;
  // The fit took after to before; the patient went the other way: R = M^T, shift = -R m.
  const Eigen::Matrix3d rotation = fit.motion.rotation.transpose();
  const Eigen::AngleAxisd turn(rotation);
  result.shift_mm = -(rotation * fit.motion.shift);
  result.rotation_deg = turn.angle() * kDegrees * turn.axis();
  result.X_after_before.linear() = rotation;
  result.X_after_before.translation() = s.about + result.shift_mm - rotation * s.about;
  result.score = fit.score;
  result.points = fit.used;
  result.gain = fit.gain;
  result.bias = fit.bias;
  const Point centre = s.box.centre();
  result.within_limits = (result.X_after_before * centre - centre).norm() <= s.shift_max_mm &&
                         turn.angle() * kDegrees <= s.rotation_max_deg;
  return result;
}

// The box, no larger than the images.
RegistrationSettings within_images(std::span<const Volume> after, RegistrationSettings settings) {
  std::optional<Box> images;
  for (const Volume& stack : after) {
    if (stack.voxels.empty()) continue;
    const Eigen::Vector3d last = stack.grid.size.cast<double>().array() - 1.0;
    for (int n = 0; n < 8; ++n) {
      const Point corner =
          stack.grid.X_SI *
          Eigen::Vector3d((n & 1) ? last.x() : 0.0, (n & 2) ? last.y() : 0.0, (n & 4) ? last.z() : 0.0);
      if (!images) images = Box{corner, corner};
      images->include(corner, is_thin(stack) ? 0.5 * stack.grid.spacing_mm().z() : 0.0);
    }
  }
  if (!images) return settings;
  settings.box.low = settings.box.low.cwiseMax(images->low);
  settings.box.high = settings.box.high.cwiseMin(images->high);
  return settings;
}

std::vector<Volume> all_smoothed(std::span<const Volume> stacks, const Box& box, double sigma_mm) {
  std::vector<Volume> result;
  for (const Volume& stack : stacks) {
    Volume part = smoothed_coarse(stack, box, sigma_mm);
    if (!part.voxels.empty()) result.push_back(std::move(part));
  }
  return result;
}

}  // namespace

RegistrationResult register_rigid(const Volume& before, std::span<const Volume> after,
                                  const RegistrationSettings& asked) {
  const RegistrationSettings settings = within_images(after, asked);
  const Eigen::Vector3d sides = settings.box.high - settings.box.low;
  if (sides.minCoeff() <= 0.0) return {};
  // Places enough to average noise out, few enough for a tenth of a second.
  constexpr double kCoarse = 4000.0, kFine = 30000.0;
  const double coarse_step = std::cbrt(sides.prod() / kCoarse), fine_step = std::cbrt(sides.prod() / kFine);
  Box moved = asked.box;  // with what surrounds the places that are compared
  moved.include(asked.box.low, asked.shift_max_mm);
  moved.include(asked.box.high, asked.shift_max_mm);
  const double fine_mm = 0.5 * fine_step, coarse_mm = 0.7 * coarse_step;
  const double further_mm = std::sqrt(coarse_mm * coarse_mm - fine_mm * fine_mm);  // Gaussians add up
  Volume before_fine = smoothed_coarse(before, moved, fine_mm);
  std::vector<Volume> after_fine = all_smoothed(after, moved, fine_mm);
  if (before_fine.voxels.empty() || after_fine.empty()) return {};
  Volume before_coarse = smoothed_coarse(before_fine, moved, further_mm);
  std::vector<Volume> after_coarse = all_smoothed(after_fine, moved, further_mm);
  // A slab has no neighbourhood across its slices to be compared with a volume's.
  const bool thin = std::any_of(after_coarse.begin(), after_coarse.end(), is_thin);
  Volume before_plain;  // which `plain` reads
  std::optional<Level> plain;
  if (!thin) {
    before_plain = before_coarse;
    plain.emplace(before_plain, after_coarse, settings, kCoarse);
    before_coarse = local_contrast(before_coarse, settings.mask);
    before_fine = local_contrast(before_fine, settings.mask);
    for (Volume& stack : after_coarse) stack = local_contrast(stack, settings.mask);
    for (Volume& stack : after_fine) stack = local_contrast(stack, settings.mask);
  }
  const Level coarse(before_coarse, after_coarse, settings, kCoarse);
  if (coarse.places().size() < 200) return {};

  std::vector<Fit> fits;
  for (const Motion& start : starts(coarse, std::min(settings.start_reach_mm, sides.maxCoeff() / 6.0)))
    fits.push_back(coarse.refined(start, 20));
  // A far motion whose smaller overlap happens to correlate is none where a near one explains the images.
  const auto near = [&](const Fit& fit) { return finished(fit, settings).within_limits; };
  std::stable_sort(fits.begin(), fits.end(), [&](const Fit& a, const Fit& b) {
    return std::pair(near(a) && a.score > 0.0, a.score) > std::pair(near(b) && b.score > 0.0, b.score);
  });

  const Level fine(before_fine, after_fine, settings, kFine);
  const Fit fit = fine.refined(fits.front().motion, 20);
  RegistrationResult result = finished(fit, settings);
  if (plain) {  // the brightness of the images as they are
    const Fit as_they_are = plain->matched(fit.motion);
    result.gain = as_they_are.gain, result.bias = as_they_are.bias;
  }
  for (const Fit& other : fits)
    if (other.score > fits.front().score - 0.02)
      result.runner_up_mm =
          std::max(result.runner_up_mm, distance_mm(fits.front().motion, other.motion, settings));
  return result;
}

}  // namespace biopsy::imaging
