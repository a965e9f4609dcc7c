// What a residual depends on, where the truth is written down as a formula.
#include "sim/gap/residual/residual_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::gap {
namespace {

constexpr double kSineNoise = 10e-6, kSinePeriod = 4e-3, kSeconds = 20.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

// What a residual may be made of, at one row.
struct Moment {
  double t, u, x, v, weight;
  std::size_t run, row;
};

using Law = std::function<double(const Moment&)>;

struct SineCase {
  Evidence evidence;
  std::vector<double> residual;
};

// Three sines to a run, incommensurate and different from run to run, so that no quantity stands for another.
SineCase case_of(const Law& law, std::size_t runs = 6, double noise = kSineNoise, bool still = false) {
  SineCase c;
  c.evidence.noise = kSineNoise;
  for (std::size_t r = 0; r < runs; ++r) {
    EvidenceRun run{
        .name = "run", .weight = 0.020 + 0.030 * static_cast<double>(r % 3), .rows = {}, .windows = {}};
    const double w[] = {0.31 + 0.04 * static_cast<double>(r), 0.73 - 0.03 * static_cast<double>(r), 1.37};
    for (std::size_t i = 0; i < static_cast<std::size_t>(kSeconds / kSinePeriod); ++i) {
      const double t = static_cast<double>(i) * kSinePeriod;
      double x = 4e-3, v = 0.0;
      for (std::size_t k = 0; k < 3 && !still; ++k) {
        const double phase = kTurn * w[k] * t + 1.7 * static_cast<double>(k * r);
        x += 1e-3 * std::sin(phase);
        v += 1e-3 * kTurn * w[k] * std::cos(phase);
      }
      const double amplitude = 3000.0 + 1500.0 * std::sin(kTurn * 0.11 * t + static_cast<double>(r));
      const double u = std::fmod(t + 1e-9, 1.0) < 0.5 ? amplitude : -amplitude;
      c.residual.push_back(law({t, u, x, v, run.weight, r, i}) + noise * normals(r + 1, i).first);
      run.rows.push_back({t, kSinePeriod, u, 0.0, x + c.residual.back()});
    }
    c.evidence.runs.push_back(run);
  }
  return c;
}

std::vector<ResidualShape> shapes(const SineCase& c) {
  return residual_shapes(c.evidence, PlantModel{}, c.residual);
}

double share(const std::vector<ResidualShape>& found, const std::string& quantity) {
  for (const ResidualShape& shape : found)
    if (shape.quantity == quantity) return shape.share_explained;
  return 0.0;
}

TEST(ResidualShape, QuadraticDragIsASpeedsCurve) {
  constexpr double kDrag = 2.0;  // m per (m/s)^2
  const auto found = shapes(case_of([](const Moment& m) { return kDrag * m.v * std::abs(m.v); }));
  ASSERT_FALSE(found.empty());
  const ResidualShape& best = found.front();
  EXPECT_EQ(best.quantity, "speed");
  EXPECT_EQ(best.unit, "mm/s");
  EXPECT_GT(best.share_explained, 0.95);
  for (std::size_t i = 1; i < found.size(); ++i)
    EXPECT_LT(found[i].share_explained, 0.5 * best.share_explained);
  ASSERT_GE(best.at.size(), 15u);
  for (std::size_t i = 1; i + 1 < best.at.size(); ++i) {  // in bins at the ends the square varies much
    const double v = best.at[i] * 1e-3;
    EXPECT_NEAR(best.mean[i], 1e3 * kDrag * v * std::abs(v), 0.008) << best.at[i];
  }
}

TEST(ResidualShape, WhiteNoiseDependsOnNothing) {
  EXPECT_TRUE(shapes(case_of([](const Moment&) { return 0.0; })).empty());
  EXPECT_TRUE(shapes(case_of([](const Moment&) { return 0.0; }, 1)).empty());
}

TEST(ResidualShape, AConstantDependsOnNothing) {
  EXPECT_TRUE(shapes(case_of([](const Moment&) { return 0.1e-3; })).empty());
}

TEST(ResidualShape, NoiseWithAMemoryIsHardlyTakenForACurve) {
  // Memory of 1 s: twenty effective_sample_size a run. A curve drawn from the residual itself "explains" a
  // large share.
  double largest = 0.0;
  int taken = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    double memory = 0.0;
    const double keep = std::exp(-kSinePeriod / 1.0);
    const auto found = shapes(case_of([&, seed](const Moment& m) {
      memory = m.row == 0
                   ? normals(seed * 100 + m.run, 1u << 20).first
                   : keep * memory + std::sqrt(1 - keep * keep) * normals(seed * 100 + m.run, m.row).first;
      return 0.1e-3 * memory;
    }));
    taken += found.empty() ? 0 : 1;
    for (const ResidualShape& shape : found)
      if (shape.quantity != "weight") largest = std::max(largest, shape.share_explained);
  }
  EXPECT_LT(largest,
            0.05);  // weight has as many effective_sample_size as there are runs, six: chance has its way now
                    // and then
  EXPECT_LE(taken, 4) << "of 20, eight quantities each";
}

TEST(ResidualShape, WhatFollowsAFlipIsFoundUnderAPeriodicDrive) {
  const auto found = shapes(case_of([](const Moment& m) {
    return m.t < 0.5 ? 0.0 : 0.1e-3 * std::exp(-std::fmod(m.t + 1e-9, 0.5) / 0.1);
  }));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().quantity, "time_since_reversal");
  EXPECT_GT(found.front().share_explained, 0.85);
}

TEST(ResidualShape, TheSignOfTheVoltageIsNotItsMagnitude) {
  const auto found = shapes(case_of([](const Moment& m) { return m.u > 0 ? 0.05e-3 : -0.05e-3; }));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().quantity, "voltage");
  EXPECT_GT(found.front().share_explained, 0.9);
  EXPECT_LT(share(found, "voltage_magnitude"), 0.05);
}

TEST(ResidualShape, AWrongSpringIsAPositionsCurve) {
  const auto found = shapes(case_of([](const Moment& m) { return 0.05 * (m.x - 4e-3); }));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().quantity, "position");
  EXPECT_GT(found.front().share_explained, 0.9);
}

TEST(ResidualShape, DriftAndWeightShowAcrossRunsOnly) {
  const Law drift = [](const Moment& m) { return 0.01e-3 * m.t; };
  const Law heavy = [](const Moment& m) { return 2e-3 * m.weight; };
  EXPECT_EQ(shapes(case_of(drift)).front().quantity, "time_in_run");
  EXPECT_EQ(shapes(case_of(heavy)).front().quantity, "weight");
  EXPECT_EQ(share(shapes(case_of(drift, 1)), "time_in_run"), 0.0);
}

TEST(ResidualShape, AResidualDoesNotExplainItself) {
  // The table shakes at 7 Hz, the model stands still: measured position is the residual, the model's is not.
  const auto found = shapes(
      case_of([](const Moment& m) { return 0.2e-3 * std::sin(kTurn * 7.03 * m.t); }, 6, kSineNoise, true));
  EXPECT_EQ(share(found, "position"), 0.0);
  EXPECT_EQ(share(found, "acceleration"), 0.0);
}

TEST(ResidualShape, BestComesFirst) {
  const auto found =
      shapes(case_of([](const Moment& m) { return 0.02 * (m.x - 4e-3) + 1.0 * m.v * std::abs(m.v); }));
  ASSERT_GE(found.size(), 2u);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const ResidualShape& a, const ResidualShape& b) {
    return a.share_explained > b.share_explained;
  }));
}

}  // namespace
}  // namespace biopsy::sim::gap
