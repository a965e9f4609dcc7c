#include "planner/plan/nominal_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace biopsy::planner {
namespace {

TEST(FilmShare, IsTheSteadyStateOfTheLeakageEquation) {
  // Equation (2) sample by sample: a step of the input passes with K, between steps the output decays with
  // tau.
  const double a = 0.25, tau = 6.9, K = 0.8;
  double output = 0.0, input = 0.0;
  for (int half_period = 0; half_period < 800; ++half_period) {
    const double next = half_period % 2 == 0 ? 1.0 : -1.0;
    output = output * (half_period == 0 ? 1.0 : std::exp(-a / tau)) + K * (next - input);
    input = next;
  }
  const FilmShare share = film_share({});
  EXPECT_NEAR(std::abs(output), share.start, 1e-9);
  EXPECT_NEAR(std::abs(output) * std::exp(-a / tau), share.end, 1e-9);
  double mean_square = 0.0;
  for (int n = 0; n < 1000; ++n)
    mean_square += std::pow(output * std::exp(-(n + 0.5) * a / 1000 / tau), 2) / 1000;
  EXPECT_NEAR(std::sqrt(mean_square), share.rms, 1e-6);
  EXPECT_NEAR(share.start - share.end, 0.0290, 1e-4);  // 2 K (1 - e^(-a/tau)) / (1 + e^(-a/tau))
}

TEST(NominalModel, AgreesWithHandArithmetic) {
  // 50 g at 6 kV: film voltage 4799.7 V, P = 3.4 * 8.854e-12 * 4799.7^2 / 2e-8 = 34676 Pa, load 0.110 * 9.81
  // = 1.0791 N, S = 1.0791 / (0.06 * 34676) = 0.51866 mm, H = 2 / pi (sqrt(0.51866^2 + 9.9484) - 0.51866)
  // = 1.7048 mm, 11 (1.7048 - 0.35) = 14.90 mm.
  EXPECT_NEAR(NominalModel(Grams(50)).depth(Volts(6000)).value, 14.90, 0.01);
  // 1.2 N back on the needle: load 2.2791 N, S = 1.0954 mm, H = 1.4284 mm, 11.863 mm less 1.2 N / 140 N/m
  // = 8.571 mm.
  EXPECT_NEAR(NominalModel(Grams(50)).depth(Volts(6000), 1.2).value, 3.29, 0.01);
}

TEST(NominalModel, SatisfiesTheVolumeAndForceEquations) {
  const double L0 = 0.060, V0 = 1.9e-7, permittivity = 3.4 * 8.8541878128e-12, film = 100e-6;
  for (const double grams : {0.0, 20.0, 50.0, 260.0})
    for (double volts = 3200; volts <= 8000; volts += 400) {
      const double depth = NominalModel(Grams(grams)).depth(Volts(volts)).value * 1e-3;
      ASSERT_GT(depth, 0.0);
      const double H = 0.35e-3 + depth / 11;
      const double film_volts = film_share({}).rms * volts;
      const double pressure = permittivity * film_volts * film_volts / (2 * film * film);
      const double S = (0.060 + grams * 1e-3) * 9.81 / (L0 * pressure);                   // (19)
      EXPECT_NEAR((H * S + std::numbers::pi * H * H / 4) * L0 / V0, 1.0, 1e-9) << volts;  // (18)
    }
}

TEST(NominalModel, RestsAtZeroBelowLiftOff) {
  const NominalModel model(Grams(50));
  EXPECT_EQ(model.depth(Volts(0)).value, 0.0);
  EXPECT_NEAR(model.depth(Volts(1e-6)).value, 0.0, 1e-9);
  EXPECT_NEAR(model.depth(Volts(1400)).value, 0.0, 1e-9);
  EXPECT_GT(model.depth(Volts(1600)).value, 0.1);
}

TEST(NominalModel, DriveAndDepthAreInverse) {
  for (const double grams : {0.0, 20.0, 50.0, 100.0, 260.0})
    for (const double force : {-0.1, 0.0, 0.4, 1.2})
      for (double depth = 0.5; depth <= 11.0; depth += 0.5) {
        const NominalModel model{Grams(grams)};
        const auto drive = model.drive(Millimetres(depth), force);
        if (!drive || drive->value == 0.0) continue;
        EXPECT_NEAR(model.depth(*drive, force).value, depth, 1e-6) << grams << " g, " << force << " N";
      }
}

TEST(NominalModel, MoreDriveLiftsMoreAndMoreForceLess) {
  const NominalModel model(Grams(50));
  for (double volts = 2000; volts < 8000; volts += 100) {
    EXPECT_GT(model.depth(Volts(volts + 100)), model.depth(Volts(volts)));
    EXPECT_LT(model.depth(Volts(volts), 0.1), model.depth(Volts(volts)));
  }
}

TEST(NominalModel, SaysWhenNoDriveCouldDoIt) {
  EXPECT_FALSE(NominalModel(Grams(50)).drive(Millimetres(25)).has_value());
  EXPECT_TRUE(NominalModel(Grams(50)).drive(Millimetres(11)).has_value());
}

TEST(DriveLimit, LetsTheStageReachItsDepthAgainstTissueAndHysteresis) {
  for (const double grams : {0.0, 20.0, 50.0, 100.0, 300.0})
    for (double depth = 0.5; depth <= 11.0; depth += 0.05) {
      const NominalModel model{Grams(grams)};
      const Volts limit = model.drive_limit(Millimetres(depth));
      EXPECT_LE(limit.value, 8000.0);
      if (limit.value < 8000.0) {
        EXPECT_GE(model.depth(limit, 1.2).value, 1.3 * depth) << grams << " g, " << depth << " mm";
      }
    }
}

TEST(DriveLimit, RunOfTheNeedleAfterASuddenLossStaysWithinTheMargin) {
  // At the limit the loop holds the depth; 0.15 N vanish, the rest of 1.2 N stays; 1 mm on the loop has taken
  // 800 V.
  for (const double grams : {0.0, 20.0, 50.0, 100.0})
    for (double depth = 0.5; depth <= 5.0; depth += 0.05) {
      const NominalModel model{Grams(grams)};
      const Volts limit = model.drive_limit(Millimetres(depth));
      if (limit.value < 8000.0) {
        EXPECT_LE(model.depth(limit - Volts(800), 1.05).value, 1.3 * depth + 1.0 + 1e-6)
            << grams << " g, " << depth;
      }
    }
}

TEST(DriveLimit, LeavesTheLoopNoMoreThanItsHeadroom) {
  for (const double grams : {0.0, 20.0, 50.0, 100.0})
    for (double depth = 0.5; depth <= 5.0; depth += 0.05) {
      const NominalModel model{Grams(grams)};
      const auto needed = model.drive(Millimetres(1.3 * depth), 1.2);
      ASSERT_TRUE(needed.has_value());
      EXPECT_LE(model.drive_limit(Millimetres(depth)).value, needed->value + 500.0 + 1e-6)
          << grams << " g, " << depth;
    }
}

TEST(DriveLimit, RisesWithDepth) {
  const NominalModel model(Grams(50));
  for (double depth = 0.5; depth < 11.0; depth += 0.1)
    EXPECT_LE(model.drive_limit(Millimetres(depth)), model.drive_limit(Millimetres(depth + 0.1)));
}

TEST(PlausibleDepths, HoldWhatAHealthyStageDoesAndFindAGrossError) {
  for (const double grams : {20.0, 50.0, 100.0}) {
    const NominalModel model{Grams(grams)};
    const auto bands = model.plausible_depths();
    ASSERT_EQ(bands.size(), 17u);
    for (std::size_t n = 0; n < bands.size(); ++n) {
      EXPECT_EQ(bands[n].drive.value, 500.0 * static_cast<double>(n));
      for (const double force : {0.0, 0.3, 0.6, 1.0})
        for (const double share : {0.7, 1.0}) {  // of the strain: hysteresis
          const double depth = std::max(0.0, share * model.depth(bands[n].drive, force).value);
          EXPECT_GE(depth, bands[n].low.value);
          EXPECT_LE(depth, bands[n].high.value);
        }
      if (n > 0) {
        EXPECT_GE(bands[n].low, bands[n - 1].low);
        EXPECT_GE(bands[n].high, bands[n - 1].high);
      }
    }
    EXPECT_LT(bands[0].high.value, 5.0);  // without drive no healthy needle reads 5 mm
    EXPECT_GT(bands[16].low.value, 0.0);  // and at full drive none reads zero
  }
}

}  // namespace
}  // namespace biopsy::planner
