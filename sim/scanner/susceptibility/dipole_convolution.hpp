// The field of many small magnetised cubes at once: convolution with the field of a dipole, done in k-space.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "robot/common/frames.hpp"

namespace biopsy::sim {

// Values on a cubic lattice, x fastest.
struct Lattice {
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  std::vector<float> values;

  explicit Lattice(const Eigen::Vector3i& n)
      : size(n),
        values(static_cast<std::size_t>(n.x()) * static_cast<std::size_t>(n.y()) *
               static_cast<std::size_t>(n.z())) {}
  Lattice() = default;

  std::size_t index(const Eigen::Vector3i& n) const {
    return static_cast<std::size_t>(n.x()) +
           static_cast<std::size_t>(size.x()) *
               (static_cast<std::size_t>(n.y()) +
                static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(n.z()));
  }
  float& at(const Eigen::Vector3i& n) { return values[index(n)]; }
  float at(const Eigen::Vector3i& n) const { return values[index(n)]; }
};

// Change of the field along b0 (unit vector in the lattice's axes), as a fraction of B0 for a susceptibility
// difference of 1 in the cubes whose filled fraction `body` gives, at the points of a lattice of `size` whose
// first point lies `offset` cells from the body's first. Outside the body this is the field itself; within,
// it is the field that a spin there would see (with the correction of Lorentz). First order in the
// susceptibility. The lattices are padded with zeros to the sum of both, so that no periodic image of the
// body adds to it. Time is that of three Fourier transforms of the padded lattice; rounding is that of float.
Lattice dipole_field(const Lattice& body, const Direction& b0, const Eigen::Vector3i& size,
                     const Eigen::Vector3i& offset);

}  // namespace biopsy::sim
