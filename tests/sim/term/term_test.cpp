// A force as an equation: its text in model files, and what the plant makes of it, against closed forms and a
// Runge-Kutta integrator written here.
#include "sim/term/term.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "sim/plant/model_text.hpp"
#include "sim/term/term_text.hpp"
#include "tests/sim/effects/staged_model.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

constexpr const char* kRig = "[baseline]\ndrive = \"force\"\nm = 0.08\nc_s = 0.6\nk = 140\n";

PlantModel rig_with(const std::string& term) {
  return parse_model(kRig + ("[term.proposed]\n" + term), "m.toml");
}

TEST(TermText, WhatIsWrittenReadsBackAsTheSameTerm) {
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return random() % n; };
  for (int i = 0; i < 500; ++i) {
    NotedModel made;
    made.model.baseline.drive = below(2) == 0 ? Drive::Force : Drive::Stack;
    if (made.model.baseline.drive == Drive::Force) made.notes.T.reset();
    const bool on_stack = made.model.baseline.drive == Drive::Stack;
    Term term;
    term.name = fmt::format("term_{}", i);
    for (std::size_t part = 0; part <= below(kMostTermParts); ++part) {
      TermPart one{.coefficient = std::ldexp(static_cast<double>(random()) - 2e9, -40)};
      one.powers[below(kTermFactors)] = 1;
      if (below(2) == 0)
        one.powers[static_cast<std::size_t>(TermFactor::Position)] = static_cast<std::uint8_t>(1 + below(4));
      if (below(2) == 0)
        one.powers[static_cast<std::size_t>(TermFactor::Speed)] = static_cast<std::uint8_t>(1 + below(3));
      const bool known =
          std::ranges::any_of(term.parts, [&](const TermPart& other) { return other.powers == one.powers; });
      if (!known) term.parts.push_back(one);
    }
    for (const TermRangeKey& key : range_keys(term.parts, on_stack)) {
      term.seen.*(key.range) = {-1e-3 * static_cast<double>(1 + below(900)), 0.02};
      if (key.range == &TermRanges::memory) term.memory_time = 0.25;
    }
    if (has_exponent(term.parts)) term.exponent = 0.1 * static_cast<double>(1 + below(50));
    if (has_period(term.parts)) term.period = 1e-3 * static_cast<double>(1 + below(900));
    made.notes.values[term.name + ".a"] = {0.5, "a bench"};
    made.model.terms.push_back(term);
    const std::string text = model_toml(made.model, made.notes);
    const NotedModel read = parse_noted_model(text, "m.toml");
    ASSERT_EQ(read.model.terms.size(), 1U) << text;
    EXPECT_EQ(read.model.terms.front().parts, term.parts) << text;
    EXPECT_EQ(read.model.terms.front().memory_time, term.memory_time) << text;
    EXPECT_EQ(read.model.terms.front().period, term.period) << text;
    EXPECT_EQ(read.model.terms.front().exponent, term.exponent) << text;
    EXPECT_EQ(read.notes, made.notes) << text;
    EXPECT_EQ(model_toml(read.model, read.notes), text);
  }
}

TEST(TermText, GivesEachCoefficientTheUnitThatMakesItsProductAForce) {
  const auto unit = [](const char* product, bool on_stack) {
    return coefficient_unit(parse_expression(product, "").front().powers, on_stack);
  };
  EXPECT_EQ(unit("a", true), "N");
  EXPECT_EQ(unit("a v^3", true), "N s^3/m^3");
  EXPECT_EQ(unit("a x^2 v |v|", false), "N s^2/m^4");
  EXPECT_EQ(unit("a sign(v) x", true), "N/m");
  EXPECT_EQ(unit("a u^2 q", true), "N/(V^2 m)");
  EXPECT_EQ(unit("a u", false), "1");
  EXPECT_EQ(unit("a u^3 x", false), "1/(N^2 m)");
  EXPECT_EQ(unit("a sign(v) |v|^n", false), "N (s/m)^n");
  EXPECT_EQ(unit("a x sin(kx)", true), "N/m");
}

TEST(TermText, RefusesWhatIsNoTerm) {
  const auto refused = [](const std::string& term) { return refusal([&] { rig_with(term); }); };
  const std::string range = "v_mm_s = [-10, 10]\n";
  expect_refusal(refused("a = 1\n" + range), "m.toml:", "expression");
  for (const auto& [expression, reason] : std::vector<std::pair<std::string, std::string>>{
           {"a w^3", "\"w^3\" is no factor"},
           {"a v^9", "the power of \"v^9\""},
           {"a v^", "the power of \"v^\""},
           {"a v v", "stands twice in a product"},
           {"a v + b v", "\"v\" stands twice"},
           {"v^3", "does not begin with its letter `a`"},
           {"a v + c v^2", "does not begin with its letter `b`"},
           {"a v +", "accepted"},
           {"", "it is empty"},
           {"a sign(v)^2", "a sign has no power"},
           {"a sin(kx)^2", "a sine has no power"},
           {"a |v|^n^2", "the power of \"|v|^n^2\""},
           {"a v^0.5", "the power of \"v^0.5\""},
           {"a v + b v^2 + c v^3 + d v^4 + e v^5 + f v^6 + g |v|", "more than 6 products"}}) {
    const std::string text = refused("expression = \"" + expression + "\"\na = 1\n" + range);
    if (reason == "accepted")
      EXPECT_EQ(text, "accepted");
    else
      expect_refusal(text, "m.toml:7", reason);
  }
  const std::string cubic = "expression = \"a v^3\"\n";
  expect_refusal(refused(cubic + range), "m.toml:6", "a");
  expect_refusal(refused(cubic + "a = 1\n"), "m.toml:6", "v_mm_s");
  expect_refusal(refused(cubic + "a = 1\nv_mm_s = [10, -10]\n"), "m.toml:9", "is not a range");
  expect_refusal(refused(cubic + "a = 1\nv_mm_s = [1, 2, 3]\n"), "m.toml:9", "is not a range");
  expect_refusal(refused(cubic + "a = 1\n" + range + "x_mm = [0, 1]\n"), "m.toml:", "x_mm");
  expect_refusal(refused(cubic + "a = 1\n" + range + "memory_s = 1\n"), "m.toml:", "memory_s");
  expect_refusal(refused("expression = \"a q\"\na = 1\nq_mm = [0, 1]\n"), "m.toml:", "memory_s");
  const std::string wave = "expression = \"a sin(kx)\"\na = 1\nx_mm = [0, 1]\n";
  expect_refusal(refused(wave), "m.toml:", "period_mm");
  expect_refusal(refused(wave + "period_mm = 0\n"), "m.toml:", "period_mm");
  EXPECT_EQ(refused(wave + "period_mm = 2.5\n"), "accepted");
  expect_refusal(refused(cubic + "a = 1\n" + range + "period_mm = 2.5\n"), "m.toml:", "period_mm");
  const std::string power = "expression = \"a sign(v) |v|^n\"\na = 1\n" + range;
  expect_refusal(refused(power), "m.toml:", "n");
  expect_refusal(refused(power + "n = 0\n"), "m.toml:", "n");
  EXPECT_EQ(refused(power + "n = 0.5\n"), "accepted");
  expect_refusal(refused(cubic + "a = 1\n" + range + "n = 2\n"), "m.toml:", "n");
  expect_refusal(refused(cubic + "a = 1e20\n" + range), "m.toml:7", "reaches 1e+14 N");
  expect_refusal(refused(cubic + "a = nan\n" + range), "m.toml:8", "finite");
  expect_refusal(refused(cubic + "a = { value = 1, unit = \"N s/m\" }\n" + range), "m.toml:8",
                 "give the coefficient in N s^3/m^3");
  EXPECT_EQ(
      refused(cubic + "a = { value = 1, unit = \"N s^3/m^3\", std = 0.1, source = \"bench\" }\n" + range),
      "accepted");
}

TEST(TermText, RefusesTheNameOfAnEffectAndTooManyTerms) {
  const auto named = [](const std::string& name) {
    return fmt::format("[term.{}]\nexpression = \"a\"\na = 0.01\n", name);
  };
  const auto refused = [&](const std::string& terms) {
    return refusal([&] { parse_model(kRig + terms, "m.toml"); });
  };
  EXPECT_EQ(refused(named("proposed_2")), "accepted");
  expect_refusal(refused(named("coulomb_friction")), "m.toml:", "is no name for a term");
  expect_refusal(refused(named("Proposed")), "m.toml:", "is no name for a term");
  std::string many;
  for (int i = 0; i < 5; ++i) many += named(fmt::format("t{}", i));
  expect_refusal(refused(many), "m.toml:", "5 terms");
}

TEST(TermText, AMutatedTermIsReadOrRefusedAndCanBeRun) {
  const std::string original =
      "[baseline]\n[term.proposed]\nexpression = \"a v^3 + b x^2 sign(v) + c q u + d |v|^n cos(kx)\"\n"
      "a = { value = -3, unit = \"N s^3/m^3\" }\nb = -50\nc = 0.02\nd = 0.1\nx_mm = [-1, 4]\nv_mm_s = [-30, "
      "40]\n"
      "u_V = [-3000, 3000]\nq_mm = [-4, 4]\nmemory_s = 0.3\nperiod_mm = 1.7\nn = 0.4\n";
  std::mt19937 random(11);
  int read = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string text = original;
    for (std::size_t n = 0; n <= random() % 3; ++n)
      text[11 + random() % (text.size() - 11)] = "0123456789.-+^vxuq|abcn[]{}\" \n"[random() % 30];
    try {
      const PlantModel model = parse_model(text, "m.toml");
      ++read;
      PlantState state = at_rest(model);
      for (int k = 0; k < 5; ++k) state = step(model, state, {.voltage = 3000.0}, Seconds(1e-3));
      EXPECT_TRUE(std::isfinite(state.motion.x)) << text;
    } catch (const ConfigError& error) {
      EXPECT_FALSE(error.what_is_wrong.empty());
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_LT(read, 3900);
}

TEST(TermForce, CubicDampingSlowsAMassAsItsClosedFormSays) {
  PlantModel model = bare_mass();
  model.terms = parse_model(
                    "[baseline]\ndrive = \"force\"\n[term.t]\nexpression = \"a v^3\"\na = -5\n"
                    "v_mm_s = [-1000, 1000]\n",
                    "m.toml")
                    .terms;
  PlantState state = at_rest(model);
  const double v = 0.4;
  set_state(model, state, 0.0, v);
  state = held(model, state, {}, 500);
  EXPECT_NEAR(state.motion.v, v / std::sqrt(1.0 + 2.0 * 5.0 * v * v * 0.5 / model.baseline.m), 1e-7);
}

// Every kind of factor but signs; x'' = (u - c v - k x + F) / m and q' = v - q / T.
TEST(TermForce, MovesARigAsAnIntegratorOfItsOwn) {
  const PlantModel model = rig_with(
      "expression = \"a x^2 + b x v + c v |v| + d u x + e q + f |u|\"\na = 900\nb = -60\nc = -1.5\nd = -8\n"
      "e = -30\nf = 0.02\nx_mm = [-100, 100]\nv_mm_s = [-2000, 2000]\nu_N = [-5, 5]\nq_mm = [-100, 100]\n"
      "memory_s = 0.2\n");
  struct Motion {
    double x = 0.0, v = 0.0, q = 0.0;
  } s;
  const auto slope = [](const Motion& at, double u) {
    const double force = 900 * at.x * at.x - 60 * at.x * at.v - 1.5 * at.v * std::abs(at.v) - 8 * u * at.x -
                         30 * at.q + 0.02 * std::abs(u);
    return Motion{at.v, (u - 0.6 * at.v - 140 * at.x + force) / 0.08, at.v - at.q / 0.2};
  };
  const auto moved = [](const Motion& at, const Motion& by, double h) {
    return Motion{at.x + h * by.x, at.v + h * by.v, at.q + h * by.q};
  };
  PlantState state = at_rest(model);
  double largest = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double u = 1.2 * std::sin(0.011 * k) + 0.4 * std::sin(0.037 * k);
    state = step(model, state, {.force = u}, Seconds(1e-3));
    for (int i = 0; i < 5; ++i) {
      const double h = 2e-4;
      const Motion a = slope(s, u), b = slope(moved(s, a, h / 2), u), c = slope(moved(s, b, h / 2), u),
                   d = slope(moved(s, c, h), u);
      s = moved(moved(moved(moved(s, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
    }
    largest = std::max(largest, std::abs(s.x));
    ASSERT_NEAR(state.motion.x, s.x, 1e-6) << k;
  }
  EXPECT_GT(largest, 5e-3);
}

// A body that cogs, under a drag that grows with a power of its speed; x'' = (u - c v - k x + F) / m.
TEST(TermForce, RepeatsWithPositionAndGrowsWithAPowerOfTheSpeed) {
  constexpr double kFastest = 2.0, kSlow = 0.01 * kFastest;  // m/s, seen; below, the power is a line
  const PlantModel model = rig_with(
      "expression = \"a sin(kx) + b cos(kx) + c sign(v) |v|^n\"\na = 0.3\nb = -0.2\nc = -0.25\n"
      "x_mm = [-100, 100]\nv_mm_s = [-2000, 2000]\nperiod_mm = 4\nn = 0.4\n");
  double x = 0.0, v = 0.0, largest = 0.0;
  const auto pull = [&](double at, double speed, double u) {
    const double turn = 2.0 * std::acos(-1.0) * at / 4e-3, fast = std::max(std::abs(speed), kSlow);
    return (u - 0.6 * speed - 140 * at + 0.3 * std::sin(turn) - 0.2 * std::cos(turn) -
            0.25 * speed * std::pow(fast, -0.6)) /
           0.08;
  };
  PlantState state = at_rest(model);
  for (int k = 0; k < 3000; ++k) {
    const double u = 1.4 * std::sin(0.011 * k) + 0.6 * std::sin(0.037 * k);
    state = step(model, state, {.force = u}, Seconds(1e-3));
    for (int i = 0; i < 50; ++i) {  // midpoint rule
      const double h = 2e-5, x_mid = x + 0.5 * h * v, v_mid = v + 0.5 * h * pull(x, v, u);
      x += h * v_mid;
      v += h * pull(x_mid, v_mid, u);
    }
    largest = std::max(largest, std::abs(x));
    ASSERT_NEAR(state.motion.x, x, 1e-5) << k;
  }
  EXPECT_GT(largest, 20e-3);
}

TEST(TermForce, DryFrictionThatDependsOnThePlaceHoldsThere) {
  const PlantModel model =
      rig_with("expression = \"a x^2 sign(v)\"\na = -5000\nx_mm = [-20, 20]\n");  // 0.5 N at 10 mm
  PlantState state = at_rest(model);
  set_state(model, state, 10e-3, 0.0);
  // The spring pulls with 1.4 N: a push of 1 N leaves 0.4 N, which is held; one of 0.8 N leaves 0.6.
  EXPECT_EQ(held(model, state, {.force = 1.0}, 500).motion.x, 10e-3);
  EXPECT_LT(held(model, state, {.force = 0.8}, 500).motion.x, 9.5e-3);
}

TEST(TermForce, StaysAsAtTheEdgeBeyondWhereItWasSeen) {
  const PlantModel model = rig_with("expression = \"a x^3\"\na = 1e6\nx_mm = [-5, 8]\n");
  const Term& term = model.terms.front();
  EXPECT_DOUBLE_EQ(term.force({.x = 8e-3}), 0.512);
  EXPECT_DOUBLE_EQ(term.force({.x = 80.0}), 0.512);
  EXPECT_DOUBLE_EQ(term.force({.x = -80.0}), -0.125);
}

TEST(TermForce, OnAStackIsAFunctionOfTheVoltageThatPulls) {
  PlantModel pushed, model;
  pushed.baseline.tau = model.baseline.tau = 1e6;  // no leak: the stack has K times the amplifier's voltage
  model.terms =
      parse_model("[baseline]\n[term.t]\nexpression = \"a u^2\"\na = -2e-8\nu_V = [-9000, 9000]\n", "m.toml")
          .terms;
  const double push = 2e-8 * std::pow(0.8 * 2500.0, 2);
  PlantState with = at_rest(model), without = at_rest(pushed);
  with = held(model, with, {.voltage = -2500.0}, 2000);
  without = held(pushed, without, {.voltage = -2500.0, .external_force = push}, 2000);
  EXPECT_NEAR(with.motion.x, without.motion.x, 1e-8);
  EXPECT_GT(with.motion.x, 1e-4);
}

// What a search proposes is written only where it reads back.
TEST(TermText, CanBeWrittenWhereAFileMayHoldIt) {
  const auto drag = [](double coefficient, double fastest) {
    Term term;
    term.name = "drag";
    term.parts = {{.coefficient = coefficient}};
    term.parts[0].powers[static_cast<std::size_t>(TermFactor::Speed)] = 3;
    term.seen.v = {-fastest, fastest};
    return term;
  };
  for (const auto& [coefficient, fastest] : std::vector<std::pair<double, double>>{
           {-40.0, 2.0}, {-40.0, 11.0}, {-40.0, 30.0}, {-1e-9, 900.0}, {-1e-9, 1100.0}}) {
    const Term term = drag(coefficient, fastest);
    NotedModel made;
    made.model.baseline.drive = Drive::Force;
    made.notes.T.reset();
    made.model.terms.push_back(term);
    bool written = true;
    try {
      model_toml(made.model, made.notes);
    } catch (const ConfigError&) {
      written = false;
    }
    EXPECT_EQ(can_be_written(term, false), written)
        << coefficient << " N s^3/m^3 up to " << fastest << " m/s";
  }
}

TEST(TermForce, MakesTheIntegratorsStepShort) {
  PlantModel model = rig_with("expression = \"a x^2 v\"\na = -1e5\nx_mm = [-30, 30]\nv_mm_s = [-900, 900]\n");
  const double with = fastest_rate(model, 0.02);
  model.terms.clear();
  EXPECT_GT(with, 5.0 * fastest_rate(model, 0.02));
}

TEST(TermForce, OfAModelWithoutTermsChangesNothing) {
  const PlantModel model = read_model(models_folder() / "rehearsal.toml");
  PlantModel with = model;
  with.terms =
      parse_model("[baseline]\n[term.t]\nexpression = \"a x\"\na = 0\nx_mm = [-9, 9]\n", "m.toml").terms;
  PlantState a = at_rest(model), b = at_rest(with);
  for (int k = 0; k < 4000; ++k) {
    a = step(model, a, {.voltage = ramps_and_flips(k)}, Seconds(1e-3));
    b = step(with, b, {.voltage = ramps_and_flips(k)}, Seconds(1e-3));
  }
  EXPECT_EQ(a.motion.x, b.motion.x);
}

}  // namespace
}  // namespace biopsy::sim
