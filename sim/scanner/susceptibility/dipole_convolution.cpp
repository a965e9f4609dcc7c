#include "sim/scanner/susceptibility/dipole_convolution.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <opencv2/core.hpp>

namespace biopsy::sim {
namespace {

// Complex values on a lattice, and their Fourier transform in three dimensions: cv::dft has two, so the third
// is the transform of each column over the planes.
struct Spectrum {
  Eigen::Vector3i size;
  std::vector<std::complex<float>> values;

  explicit Spectrum(const Eigen::Vector3i& n) : size(n), values(Lattice(n).values.size()) {}

  void transform(int flags) {
    const std::size_t plane = static_cast<std::size_t>(size.x()) * static_cast<std::size_t>(size.y());
    for (int k = 0; k < size.z(); ++k) {
      cv::Mat slice(size.y(), size.x(), CV_32FC2, values.data() + plane * static_cast<std::size_t>(k));
      cv::dft(slice, slice, flags);
    }
    cv::Mat planes(size.z(), static_cast<int>(plane), CV_32FC2, values.data());
    cv::Mat columns = planes.t();
    cv::dft(columns, columns, flags | cv::DFT_ROWS);
    cv::transpose(columns, planes);
  }
};

// Field of a dipole of one cell's volume at `r` cells; none at its own place, where the cube's symmetry
// cancels it.
float dipole(const Eigen::Vector3d& r, const Direction& b0) {
  const double squared = r.squaredNorm();
  if (squared == 0.0) return 0.0F;
  const double along = r.dot(b0);
  return static_cast<float>((3.0 * along * along / squared - 1.0) /
                            (4.0 * std::numbers::pi * squared * std::sqrt(squared)));
}

template <class Do>
void for_each_index(const Eigen::Vector3i& size, Do&& visit) {
  for (int k = 0; k < size.z(); ++k)
    for (int j = 0; j < size.y(); ++j)
      for (int i = 0; i < size.x(); ++i) visit(Eigen::Vector3i(i, j, k));
}

}  // namespace

Lattice dipole_field(const Lattice& body, const Direction& b0, const Eigen::Vector3i& size,
                     const Eigen::Vector3i& offset) {
  Eigen::Vector3i padded;
  for (int a = 0; a < 3; ++a) padded[a] = cv::getOptimalDFTSize(body.size[a] + size[a] - 1);
  const Lattice shape(padded);  // for its indices alone
  Spectrum source(padded), kernel(padded);
  for_each_index(body.size, [&](const Eigen::Vector3i& n) { source.values[shape.index(n)] = body.at(n); });
  // Distances from a source cell to a point run from offset - (body.size - 1) to offset + size - 1.
  for_each_index(padded, [&](const Eigen::Vector3i& n) {
    Eigen::Vector3i r;
    for (int a = 0; a < 3; ++a) r[a] = offset[a] + (n[a] < size[a] ? n[a] : n[a] - padded[a]);
    kernel.values[shape.index(n)] = dipole(r.cast<double>(), b0);
  });
  source.transform(0);
  kernel.transform(0);
  for (std::size_t n = 0; n < source.values.size(); ++n) source.values[n] *= kernel.values[n];
  source.transform(cv::DFT_INVERSE | cv::DFT_SCALE);
  Lattice field(size);
  for_each_index(size, [&](const Eigen::Vector3i& n) { field.at(n) = source.values[shape.index(n)].real(); });
  return field;
}

}  // namespace biopsy::sim
