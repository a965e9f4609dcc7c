// Regimes and traces, on evidence made by hand so that the true shares are arithmetic.
#include "sim/gap/residual/localize_residual.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "sim/gap/residual/smoothed_motion.hpp"
#include "sim/gap/residual/trace.hpp"
#include "sim/plant/seeded_noise.hpp"

namespace biopsy::sim::gap {
namespace {

using Curve = std::function<double(double)>;

constexpr double kNoise = 10e-6, kPeriod = 2e-3;

double noise_at(std::uint64_t seed, std::size_t row) {
  return kNoise * normals(seed, row).first;
}

// A run with the prediction `model`, the given residual, and noise.
struct Case {
  Evidence evidence;
  std::vector<double> before, after;

  void add(const std::string& name, double seconds, const Curve& input, const Curve& model,
           const Curve& residual, double period = kPeriod) {
    EvidenceRun run{.name = name, .rows = {}, .windows = {}};
    const std::uint64_t seed = evidence.runs.size() + 1;
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::lround(seconds / period)); ++i) {
      const double t = static_cast<double>(i) * period, noise = noise_at(seed, i);
      before.push_back(residual(t) + noise);
      after.push_back(noise);
      run.rows.push_back({t, period, input(t), 0.0, model(t) + before.back()});
      evidence.u_max = std::max(evidence.u_max, std::abs(input(t)));
      evidence.x_low = std::min(evidence.x_low, run.rows.back().measured);
      evidence.x_high = std::max(evidence.x_high, run.rows.back().measured);
    }
    run.training_rows = run.rows.size();
    evidence.noise = kNoise;
    evidence.runs.push_back(run);
  }
  std::vector<GapRegime> regimes(Drive drive = Drive::Stack) const {
    return localize_residual(evidence, before, after, drive);
  }
};

const GapRegime* find(const std::vector<GapRegime>& regimes, const std::string& name) {
  for (const GapRegime& regime : regimes)
    if (regime.name == name) return &regime;
  return nullptr;
}

double none(double) {
  return 0.0;
}
double flips(double t) {
  return static_cast<long>(t + 1e-9) % 2 == 0 ? 4000.0 : -4000.0;
}  // every second
double slow_wave(double t) {
  return 3e-3 * std::sin(2.0 * std::numbers::pi * 0.13 * t);
}

TEST(LocalizeResidual, ErrorAfterFlipsIsFoundThereWithItsTrueShare) {
  // 0.2 mm within 0.1 s after each of 19 flips, 0.05 mm otherwise.
  const auto residual = [](double t) {
    return t >= 1.0 - 1e-9 && std::fmod(t + 1e-9, 1.0) <= 0.1 + 2e-9 ? 0.2e-3 : 0.05e-3;
  };
  Case c;
  c.add("flips", 20.0, flips, slow_wave, residual);
  const std::vector<GapRegime> regimes = c.regimes();
  ASSERT_EQ(regimes.front().name, "after_reversal");
  const double time = 19 * 0.1 / 20.0, bad = time * 0.04, rest = (1.0 - time) * 0.0025;
  EXPECT_NEAR(regimes.front().share_of_time, time, 0.002);
  EXPECT_NEAR(regimes.front().share_of_excess_error, bad / (bad + rest), 0.01);
  EXPECT_NEAR(regimes.front().rmse_before, std::hypot(0.2, 0.01), 0.002);  // mm
  EXPECT_NEAR(regimes.front().rmse_after, 0.01, 0.001);
}

TEST(LocalizeResidual, JoinedRowsCountForAllTheyStandFor) {
  // The same run with every fourth row standing for four: the shares stay.
  const auto residual = [](double t) { return t >= 1.0 && std::fmod(t, 1.0) <= 0.1 ? 0.2e-3 : 0.0; };
  Case fine;
  fine.add("flips", 20.0, flips, slow_wave, residual);
  Case mixed = fine;
  mixed.evidence.runs[0].rows.clear();
  mixed.before.clear();
  mixed.after.clear();
  const std::vector<Row>& rows = fine.evidence.runs[0].rows;
  for (std::size_t i = 0; i < rows.size();) {
    const std::size_t joined = rows[i].time < 10.0 ? 4 : 1;
    mixed.evidence.runs[0].rows.push_back(rows[i]);
    mixed.evidence.runs[0].rows.back().span = static_cast<double>(joined) * kPeriod;
    mixed.before.push_back(fine.before[i]);
    mixed.after.push_back(fine.after[i]);
    i += joined;
  }
  mixed.evidence.runs[0].training_rows = mixed.evidence.runs[0].rows.size();
  for (const std::string name : {"after_reversal", "early", "late"}) {
    const std::vector<GapRegime> a = fine.regimes(), b = mixed.regimes();
    EXPECT_NEAR(find(a, name)->share_of_time, find(b, name)->share_of_time, 0.005) << name;
    EXPECT_NEAR(find(a, name)->share_of_excess_error, find(b, name)->share_of_excess_error, 0.02) << name;
  }
}

TEST(LocalizeResidual, TheOneBadRunComesFirstAndEvenRegimesLast) {
  Case c;
  c.add("good", 20.0, flips, slow_wave, [](double) { return 0.01e-3; });
  c.add("bad", 20.0, flips, slow_wave, [](double) { return 0.2e-3; });
  c.add("fine", 20.0, flips, slow_wave, [](double) { return 0.01e-3; });
  const std::vector<GapRegime> regimes = c.regimes();
  EXPECT_EQ(regimes.front().name, "run:bad");
  EXPECT_NEAR(regimes.front().share_of_time, 1.0 / 3.0, 1e-9);
  EXPECT_GT(regimes.front().share_of_excess_error, 0.99);
  const auto lift = [](const GapRegime& r) { return r.share_of_excess_error / r.share_of_time; };
  EXPECT_NEAR(lift(regimes.back()), 1.0, 0.1);
  EXPECT_LT(find(regimes, "run:good")->share_of_excess_error, 0.01);
}

TEST(LocalizeResidual, AShortBurstDoesNotComeBeforeWhatMatters) {
  // Most error is spread over the last quarter; one flip in a long run errs more, but holds 0.5 % of time.
  const auto one_flip = [](double t) { return t < 5.0 ? 4000.0 : -4000.0; };
  const auto residual = [](double t) { return t >= 15.0 ? 0.1e-3 : t >= 5.0 && t <= 5.1 ? 0.3e-3 : 0.0; };
  Case c;
  c.add("one flip", 20.0, one_flip, slow_wave, residual);
  const std::vector<GapRegime> regimes = c.regimes();
  const GapRegime* burst = find(regimes, "after_reversal");
  ASSERT_NE(burst, nullptr);
  EXPECT_GT(burst->share_of_excess_error / burst->share_of_time,
            find(regimes, "late")->share_of_excess_error / find(regimes, "late")->share_of_time);
  EXPECT_EQ(regimes.front().name, "late");
}

TEST(LocalizeResidual, NothingAboveTheNoiseHasNoShareAnywhere) {
  Case c;
  c.add("noise", 20.0, flips, slow_wave, none);
  for (std::size_t i = 0; i < c.before.size(); ++i) c.before[i] = i % 2 ? kNoise : -kNoise;
  for (const GapRegime& regime : c.regimes())
    EXPECT_NEAR(regime.share_of_excess_error, 0.0, 1e-9) << regime.name;
}

TEST(LocalizeResidual, StuckIsWhereTheModelMovesAndThePlateDoesNot) {
  // The model goes up and down at 1 mm/s; the plate stays for the first second after each turn, every 4 s.
  const auto triangle = [](double t) {
    const double phase = std::fmod(t, 8.0);
    return 1e-3 * (phase < 4.0 ? phase : 8.0 - phase);
  };
  const auto residual = [&](double t) {
    const double phase = std::fmod(t, 4.0), turned = t - phase;
    return t >= 4.0 && phase < 1.0
               ? triangle(turned) - triangle(t)
               : (t < 4.0 ? 0.0 : (triangle(turned) - triangle(turned + 1.0)) * (4.0 - phase) / 3.0);
  };
  Case c;
  c.add(
      "triangle", 40.0, [](double t) { return 1000.0 + 10.0 * t; }, triangle, residual);
  const std::vector<GapRegime> regimes = c.regimes();
  const GapRegime* stuck = find(regimes, "stuck");
  ASSERT_NE(stuck, nullptr);
  EXPECT_NEAR(stuck->share_of_time, 9.0 / 40.0, 0.04);
  EXPECT_NEAR(find(regimes, "rising")->share_of_time, (4.0 + 4 * 3.0) / 40.0, 0.05);
  EXPECT_NEAR(find(regimes, "falling")->share_of_time, 5 * 3.0 / 40.0, 0.05);
}

TEST(LocalizeResidual, ATurningPointIsNotStuck) {
  Case c;
  c.add("wave", 40.0, flips, slow_wave, [](double t) { return 0.1 * slow_wave(t); });
  EXPECT_EQ(find(c.regimes(), "stuck"), nullptr);
}

TEST(LocalizeResidual, HoldingNeedsASteadyDriveWhateverItsSign) {
  Case held, ramped;
  held.add(
      "held", 20.0, flips, [](double) { return 2e-3; }, [](double) { return 0.05e-3; });
  ramped.add(
      "ramped", 20.0, [](double t) { return 250.0 * t; }, [](double) { return 2e-3; },
      [](double) { return 0.05e-3; });
  EXPECT_GT(find(held.regimes(), "holding")->share_of_time, 0.95);
  const std::vector<GapRegime> regimes = ramped.regimes();
  EXPECT_LT(find(regimes, "holding") ? find(regimes, "holding")->share_of_time : 0.0, 0.6);
}

TEST(LocalizeResidual, ThirdsAndQuartersAreThirdsAndQuarters) {
  Case c;
  c.add(
      "ramp", 30.0, [](double t) { return 200.0 * t; }, [](double t) { return 0.3e-3 * t; },
      [](double t) { return t < 10.0 ? 0.1e-3 : 0.0; });
  const std::vector<GapRegime> regimes = c.regimes();
  for (const std::string name : {"low_voltage", "high_voltage", "shallow", "deep"})
    EXPECT_NEAR(find(regimes, name)->share_of_time, 1.0 / 3.0, 0.02) << name;
  EXPECT_NEAR(find(regimes, "early")->share_of_time, 0.25, 1e-3);
  EXPECT_NEAR(find(regimes, "late")->share_of_time, 0.25, 1e-3);
  EXPECT_NEAR(find(regimes, "early")->share_of_excess_error, 0.75, 0.01);
  EXPECT_GT(find(regimes, "low_voltage")->share_of_excess_error, 0.97);
  EXPECT_EQ(find(regimes, "low_force"), nullptr);
  EXPECT_NE(find(c.regimes(Drive::Force), "low_force"), nullptr);
}

TEST(LocalizeResidual, ADropThroughSplitsARunAndAModelledStepDoesNot) {
  const auto ramp = [](double t) { return 0.3e-3 * t; };
  const auto jump = [](double t) { return t > 12.0 ? 2e-3 * (1.0 - std::exp(-(t - 12.0) / 0.01)) : 0.0; };
  const auto steady = [](double) { return 3000.0; };
  Case puncture, step, smooth;
  puncture.add("puncture", 20.0, steady, ramp, jump);
  step.add(
      "step", 20.0, steady, [&](double t) { return ramp(t) + jump(t); }, none);
  smooth.add("smooth", 20.0, steady, ramp, [](double t) { return 0.1e-3 * std::sin(t); });
  Case missed;  // an even climb that the model lacks is no puncture
  missed.add("missed", 1.0, steady, none, [](double t) { return 6e-3 * t; });
  EXPECT_EQ(find(missed.regimes(), "after_puncture"), nullptr);
  ASSERT_NE(find(puncture.regimes(), "after_puncture"), nullptr);
  EXPECT_NEAR(find(puncture.regimes(), "after_puncture")->share_of_time, 8.0 / 20.0, 0.01);
  EXPECT_NEAR(find(puncture.regimes(), "before_puncture")->share_of_time, 12.0 / 20.0, 0.01);
  EXPECT_GT(find(puncture.regimes(), "after_puncture")->share_of_excess_error, 0.95);
  EXPECT_EQ(find(step.regimes(), "after_puncture"), nullptr);
  EXPECT_EQ(find(smooth.regimes(), "after_puncture"), nullptr);
}

TEST(LocalizeResidual, AForceDrivenMotionReversesWhereItTurnsAround) {
  // sin(2 pi 0.5 t): turns at 0.5 s and every second after that, 20 times within 20 s.
  const auto wave = [](double t) { return 3e-3 * std::sin(2.0 * std::numbers::pi * 0.5 * t); };
  const auto residual = [](double t) { return std::fmod(t + 0.5, 1.0) < 0.1 ? 0.2e-3 : 0.0; };
  Case c;  // the model is wrong there, the measured motion is smooth
  c.add(
      "wave", 20.0, [](double t) { return std::cos(t); }, [&](double t) { return wave(t) - residual(t); },
      residual);
  const std::vector<GapRegime> regimes = c.regimes(Drive::Force);
  const GapRegime* turned = find(regimes, "after_reversal");
  ASSERT_NE(turned, nullptr);
  EXPECT_NEAR(turned->share_of_time, 20 * 0.1 / 20.0, 0.01);
  EXPECT_GT(turned->share_of_excess_error, 0.85);
}

TEST(SmoothedMotion, SpeedIsMeaningfulFromTwentyHertzToAHundredKilohertz) {
  struct Recorder {
    double rate, noise, frequency, seconds;
  };
  for (const Recorder& r :
       {Recorder{20, 1e-6, 0.3, 40}, Recorder{20, 50e-6, 0.3, 40}, Recorder{1e3, 50e-6, 1, 20},
        Recorder{1e3, 1e-6, 5, 20}, Recorder{1e5, 20e-6, 20, 1}}) {
    EvidenceRun run;
    std::vector<double> readings;
    const double omega = 2.0 * std::numbers::pi * r.frequency, amplitude = 2e-3;
    for (std::size_t i = 0; i < static_cast<std::size_t>(r.seconds * r.rate); ++i) {
      const double t = static_cast<double>(i) / r.rate;
      readings.push_back(amplitude * std::sin(omega * t) + r.noise * normals(7, i).first);
      run.rows.push_back({t, 1.0 / r.rate, 0.0, 0.0, readings.back()});
    }
    const SmoothedMotion motion = smoothed_motion(run, readings, r.noise);
    double square = 0.0, scatter = 0.0;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const double v = amplitude * omega * std::cos(omega * run.rows[i].time);
      square += (motion.v[i] - v) * (motion.v[i] - v);
      scatter += v * v;
    }
    EXPECT_LT(std::sqrt(square / scatter), 0.12) << r.rate << " Hz, " << r.noise * 1e6 << " um";
  }
}

TEST(SmoothedMotion, StatesTheNoiseOfItsSpeed) {
  EvidenceRun run;
  std::vector<double> readings;
  for (std::size_t i = 0; i < 20000; ++i) {
    readings.push_back(noise_at(3, i));
    run.rows.push_back({static_cast<double>(i) * 1e-3, 1e-3, 0.0, 0.0, readings.back()});
  }
  const SmoothedMotion motion = smoothed_motion_within(run, readings, kNoise, 0.02);
  double square = 0.0;
  for (const double v : motion.v) square += v * v;
  EXPECT_NEAR(std::sqrt(square / 20000.0) / motion.speed_noise, 1.0, 0.1);
}

TEST(MainRegime, NamesEveryRowByItsFirstThatHolds) {
  Case c;
  c.add("wave", 20.0, flips, slow_wave, none);
  const MainRegimes main = main_regime(c.evidence, c.before, Drive::Stack);
  ASSERT_EQ(main.of_row.size(), c.before.size());
  const auto name_at = [&](double t) {
    return main.names.at(main.of_row[static_cast<std::size_t>(std::lround(t / kPeriod))]);
  };
  EXPECT_EQ(name_at(0.05), "rising");  // no reversal before it
  EXPECT_EQ(name_at(1.05), "after_reversal");
  EXPECT_EQ(name_at(1.5), "rising");
  EXPECT_EQ(name_at(3.5), "falling");
  EXPECT_EQ(name_at(0.25 / 0.13), "holding");  // top of the wave
}

TEST(Trace, ThinsARunAndKeepsItsWorstMoment) {
  Case c;
  const auto spike = [](double t) { return std::abs(t - 7.0) < 0.6 * kPeriod / 10 ? 0.9e-3 : 0.0; };
  c.add("long", 20.0, flips, slow_wave, spike, kPeriod / 10);
  c.add("short", 2.0, flips, slow_wave, none);
  c.evidence.runs[1].training_rows = 0;
  const auto drawn =
      traces(c.evidence, c.before, c.after, main_regime(c.evidence, c.before, Drive::Stack), Drive::Stack);
  ASSERT_EQ(drawn.size(), 2u);
  const GapTrace& trace = drawn[0];
  EXPECT_LE(trace.time.size(), kMostTracePoints);
  EXPECT_GT(trace.time.size(), kMostTracePoints / 2);
  double worst = 0.0;
  for (std::size_t i = 0; i < trace.time.size(); ++i) {
    worst = std::max(worst, trace.measured[i] - trace.before[i]);
    EXPECT_TRUE(i == 0 || trace.time[i] > trace.time[i - 1]);
    EXPECT_NEAR(std::abs(trace.input[i]), 4.0, 1e-12);  // kV
    EXPECT_NEAR(trace.before[i], 1e3 * slow_wave(trace.time[i]), 1e-9);
  }
  EXPECT_NEAR(worst, 0.9, 0.05);
  EXPECT_FALSE(trace.held_out);
  EXPECT_TRUE(drawn[1].held_out);
  EXPECT_EQ(drawn[1].time.size(), 1000u);
  for (const auto* v : {&trace.input, &trace.measured, &trace.before, &trace.after})
    EXPECT_EQ(v->size(), trace.time.size());
  EXPECT_EQ(trace.regime.size(), trace.time.size());
}

TEST(Trace, ARunHeldOutInPartIsDrawnInTwoParts) {
  Case c;
  c.add(
      "only", 3.0, [](double) { return 0.5; }, slow_wave, none);
  c.evidence.runs[0].training_rows = 1000;
  const auto drawn =
      traces(c.evidence, c.before, c.after, main_regime(c.evidence, c.before, Drive::Force), Drive::Force);
  ASSERT_EQ(drawn.size(), 2u);
  EXPECT_FALSE(drawn[0].held_out);
  EXPECT_TRUE(drawn[1].held_out);
  EXPECT_EQ(drawn[0].time.size(), 1000u);
  EXPECT_NEAR(drawn[1].time.front(), 2.0, 1e-9);
  EXPECT_EQ(drawn[0].input.front(), 0.5);  // N
}

}  // namespace
}  // namespace biopsy::sim::gap
