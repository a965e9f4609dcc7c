#include "sim/scanner/susceptibility/needle_image.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {
namespace {

constexpr double kFinest_mm = 0.2, kCoarsest_mm = 1.0;  // subvoxels near the needle and far from it
constexpr int kMostParts = 24;                          // of a voxel along one axis
constexpr double kReachMax_mm = 30.0;

double sinc(double cycles) {
  const double x = std::numbers::pi * cycles;
  return std::abs(x) < 1e-6 ? 1.0 : std::sin(x) / x;
}

// An interval along one axis of the image, in voxels.
struct Interval {
  double from = 0.0, to = 0.0;

  static Interval about(double centre, double width) {
    const double half = 0.5 * std::max(std::abs(width), 1e-6);
    return {centre - half, centre + half};
  }
};

// How much of what lies in an interval through the slices is seen in slice k.
class SliceProfile {
 public:
  SliceProfile(const Sequence& sequence, double spacing_mm, int slices)
      : gaussian_(sequence.profile == Sequence::Profile::Gaussian),
        thickness_((sequence.slice_thickness_mm > 0.0 ? sequence.slice_thickness_mm : spacing_mm) /
                   spacing_mm),
        slices_(slices) {}

  double thickness() const { return thickness_; }  // in slices
  double reach() const { return gaussian_ ? 2.0 * thickness_ : 0.5 * thickness_; }
  double share(const Interval& w, int k) const {
    return (integral(w.to - k) - integral(w.from - k)) / (w.to - w.from);
  }
  double whole(int k) const { return integral(slices_ - 0.5 - k) - integral(-0.5 - k); }

 private:
  double integral(double w) const {
    if (!gaussian_) return std::clamp(w / thickness_ + 0.5, 0.0, 1.0);
    const double sigma = thickness_ / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
    return 0.5 * std::erfc(-w / (std::numbers::sqrt2 * sigma));
  }

  bool gaussian_;
  double thickness_;
  int slices_;
};

// Complex signal of a part of the image: some rows and columns, all slices.
class Signal {
 public:
  Signal(const Eigen::Vector3i& low, const Eigen::Vector3i& size, int read_axis, const SliceProfile& profile)
      : low_(low), size_(size), read_(read_axis), profile_(profile), values_(Grid{size}.voxel_count()) {}

  // Adds what lies in `u` along the read axis and in `w` through the slices at `line` of the remaining axis.
  void add(const Interval& u, int line, const Interval& w, std::complex<double> amplitude) {
    const int k_from = std::max(low_.z(), static_cast<int>(std::ceil(w.from - profile_.reach())));
    const int k_to =
        std::min(low_.z() + size_.z() - 1, static_cast<int>(std::floor(w.to + profile_.reach())));
    const int u_from = std::max(low_[read_], static_cast<int>(std::floor(u.from + 0.5)));
    const int u_to = std::min(low_[read_] + size_[read_] - 1, static_cast<int>(std::floor(u.to + 0.5)));
    for (int k = k_from; k <= k_to; ++k) {
      const std::complex<double> in_slice = amplitude * profile_.share(w, k);
      for (int n = u_from; n <= u_to; ++n) {
        const double overlap = std::min(u.to, n + 0.5) - std::max(u.from, n - 0.5);
        if (overlap <= 0.0) continue;
        Eigen::Vector3i index;
        index[read_] = n, index[1 - read_] = line, index.z() = k;
        values_[at(index)] += std::complex<float>(in_slice * (overlap / (u.to - u.from)));
      }
    }
  }

  void magnitude(Volume& image) const {
    for (int k = 0; k < size_.z(); ++k)
      for (int j = 0; j < size_.y(); ++j)
        for (int i = 0; i < size_.x(); ++i) {
          const Eigen::Vector3i n = low_ + Eigen::Vector3i(i, j, k);
          image.voxels[image.grid.index(n.x(), n.y(), n.z())] =
              std::abs(values_[at(n)]) / static_cast<float>(profile_.whole(n.z()));
        }
  }

 private:
  std::size_t at(const Eigen::Vector3i& n) const {
    return Grid{size_}.index(n.x() - low_.x(), n.y() - low_.y(), n.z() - low_.z());
  }

  Eigen::Vector3i low_, size_;
  int read_;
  const SliceProfile& profile_;
  std::vector<std::complex<float>> values_;
};

class Renderer {
 public:
  Renderer(const Volume& tissue, const NeedleField& field, const Sequence& sequence)
      : tissue_(tissue),
        field_(field),
        sequence_(sequence),
        profile_(sequence, tissue.grid.spacing_mm().z(), tissue.grid.size.z()),
        read_(sequence.read_axis) {
    const bool gradient = sequence.echo == Sequence::Echo::Gradient;
    echo_time_s_ = gradient ? sequence.echo_time_ms * 1e-3 : 0.0;
    voxels_per_Hz_ = (sequence.read_reversed ? -1.0 : 1.0) / sequence.bandwidth_Hz_per_pixel;
    if (sequence.slice_bandwidth_Hz > 0.0)
      slices_per_Hz_ = profile_.thickness() / sequence.slice_bandwidth_Hz;
    // Beyond: moved by less than a twentieth of a voxel, phases below a tenth of a turn.
    double least_Hz = 0.05 * sequence.bandwidth_Hz_per_pixel;
    if (slices_per_Hz_ > 0.0) least_Hz = std::min(least_Hz, 0.05 / slices_per_Hz_);
    if (echo_time_s_ > 0.0) least_Hz = std::min(least_Hz, 0.1 / echo_time_s_);
    reach_mm_ = std::min(field.reach(least_Hz / sequence.larmor_Hz()), kReachMax_mm) +
                0.5 * tissue.grid.spacing_mm().norm();
  }

  Volume render() const {
    Volume image = tissue_;
    Eigen::Vector3i low, high;
    const bool near = find_part(low, high);
    const bool plain = sequence_.profile == Sequence::Profile::Box && profile_.thickness() == 1.0;
    if (!plain) low = Eigen::Vector3i::Zero(), high = tissue_.grid.size.array() - 1;
    if (plain && !near) return image;
    Signal signal(low, high - low + Eigen::Vector3i::Ones(), read_, profile_);
    for (int k = low.z(); k <= high.z(); ++k)
      for (int j = low.y(); j <= high.y(); ++j)
        for (int i = low.x(); i <= high.x(); ++i) add_voxel({i, j, k}, signal);
    signal.magnitude(image);
    return image;
  }

 private:
  double offset_Hz(const Eigen::Vector3d& index) const {
    return sequence_.larmor_Hz() * field_.at(tissue_.grid.X_SI * index);
  }

  // The rows and columns that the needle changes, with room for what is moved; all slices.
  bool find_part(Eigen::Vector3i& low, Eigen::Vector3i& high) const {
    const Grid& grid = tissue_.grid;
    low = grid.size, high = Eigen::Vector3i::Constant(-1);
    for (int k = 0; k < grid.size.z(); ++k)
      for (int j = 0; j < grid.size.y(); ++j)
        for (int i = 0; i < grid.size.x(); ++i)
          if (field_.distance(grid.X_SI * Eigen::Vector3d(i, j, k)) < reach_mm_) {
            low = low.cwiseMin(Eigen::Vector3i(i, j, k));
            high = high.cwiseMax(Eigen::Vector3i(i, j, k));
          }
    if (high.x() < 0) return false;
    const int moved =
        static_cast<int>(std::ceil(std::abs(field_.largest() * sequence_.larmor_Hz() * voxels_per_Hz_)));
    low[read_] -= moved + 1, high[read_] += moved + 1;
    low.z() = 0, high.z() = grid.size.z() - 1;
    low = low.cwiseMax(0);
    high = high.cwiseMin((grid.size.array() - 1).matrix());
    return true;
  }

  void add_voxel(const Eigen::Vector3i& voxel, Signal& signal) const {
    const double value = static_cast<double>(tissue_.at(voxel.x(), voxel.y(), voxel.z()));
    if (value == 0.0) return;
    const Eigen::Vector3d index = voxel.cast<double>();
    const double distance = field_.distance(tissue_.grid.X_SI * index);
    if (distance > reach_mm_) {
      signal.add(Interval::about(index[read_], 1.0), voxel[1 - read_], Interval::about(index.z(), 1.0),
                 value);
      return;
    }
    const Eigen::Vector3d spacing = tissue_.grid.spacing_mm();
    const double step = std::clamp((distance - 0.5 * spacing.norm()) / 8.0, kFinest_mm, kCoarsest_mm);
    Eigen::Vector3i parts;
    for (int a = 0; a < 3; ++a)
      parts[a] = std::clamp(static_cast<int>(std::ceil(spacing[a] / step)), 1, kMostParts);
    const Eigen::Vector3d part = parts.cast<double>().cwiseInverse();
    for (int k = 0; k < parts.z(); ++k)
      for (int j = 0; j < parts.y(); ++j)
        for (int i = 0; i < parts.x(); ++i) {
          const Eigen::Vector3d within = (Eigen::Vector3d(i, j, k).array() + 0.5).matrix().cwiseProduct(part);
          add_subvoxel(index + within - Eigen::Vector3d::Constant(0.5), part, voxel[1 - read_],
                       value * part.prod(), signal);
        }
  }

  void add_subvoxel(const Eigen::Vector3d& centre, const Eigen::Vector3d& part, int line, double amount,
                    Signal& signal) const {
    if (field_.inside(tissue_.grid.X_SI * centre)) return;
    const double offset = offset_Hz(centre);
    Eigen::Vector3d change;  // across the subvoxel, Hz
    for (int a = 0; a < 3; ++a) {
      const Eigen::Vector3d half = 0.5 * part[a] * Eigen::Vector3d::Unit(a);
      change[a] = offset_Hz(centre + half) - offset_Hz(centre - half);
      amount *= sinc(change[a] * echo_time_s_);
    }
    signal.add(Interval::about(centre[read_] + offset * voxels_per_Hz_,
                               part[read_] + change[read_] * voxels_per_Hz_),
               line,
               Interval::about(centre.z() + offset * slices_per_Hz_, part.z() + change.z() * slices_per_Hz_),
               std::polar(1.0, 2.0 * std::numbers::pi * offset * echo_time_s_) * amount);
  }

  const Volume& tissue_;
  const NeedleField& field_;
  const Sequence& sequence_;
  SliceProfile profile_;
  int read_;
  double echo_time_s_ = 0.0, voxels_per_Hz_ = 0.0, slices_per_Hz_ = 0.0, reach_mm_ = 0.0;
};

}  // namespace

Volume image_with_needle(const Volume& tissue, const NeedleField& field, const Sequence& sequence) {
  refuse_bad_sequence(sequence, "sequence");
  if (tissue.grid.voxel_count() == 0 || tissue.voxels.size() != tissue.grid.voxel_count())
    throw ConfigError("a volume without voxels", "simulated scanner", "give an image");
  return Renderer(tissue, field, sequence).render();
}

Volume image_with_needle(const Volume& tissue, const NeedleBody& needle, const Sequence& sequence) {
  return image_with_needle(tissue, NeedleField(needle, sequence.b0_S), sequence);
}

}  // namespace biopsy::sim
