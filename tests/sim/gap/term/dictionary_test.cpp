// What a term is made of, and what it may be physically. Inputs: motions and expressions by hand.
#include "sim/gap/term/dictionary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/gap/term/term_meaning.hpp"
#include "sim/term/term_text.hpp"

namespace biopsy::sim::gap {
namespace {

bool holds(const std::vector<DictionaryEntry>& entries, const std::string& expression) {
  const TermPowers powers = parse_expression(expression, "").front().powers;
  return std::ranges::any_of(entries, [&](const DictionaryEntry& entry) { return entry.powers == powers; });
}

// A motion with all of position and speed, driven by one drive a row.
MotionRows driven_by(double (*drive)(int)) {
  MotionRows out;
  for (int i = 0; i < 200; ++i) {
    const double phase = 0.11 * i;
    out.points.push_back({.x = std::sin(phase) + 0.3 * std::sin(2.7 * phase),
                          .v = std::cos(phase) + 0.8 * std::cos(2.7 * phase),
                          .drive = drive(i)});
    out.times.push_back(0.01);
    out.begins.push_back(i == 0);
  }
  return out;
}

// A square wave of one size: its square is a constant, and no term says so in another way.
TEST(Dictionary, HoldsOneOfTheProductsThatARecordingDoesNotTellApart) {
  const auto square_wave = distinct_entries(driven_by([](int i) { return i / 20 % 2 == 0 ? 1.0 : -1.0; }));
  EXPECT_TRUE(holds(square_wave, "a"));
  EXPECT_TRUE(holds(square_wave, "a u"));
  for (const char* same : {"a u^2", "a |u|", "a |u| u", "a u^3", "a u^2 sign(v)", "a |u| x"})
    EXPECT_FALSE(holds(square_wave, same)) << same;
  const auto of_two_sizes = distinct_entries(
      driven_by([](int i) { return (i / 20 % 2 == 0 ? 1.0 : -1.0) * (i < 100 ? 1.0 : 0.6); }));
  EXPECT_TRUE(holds(of_two_sizes, "a u^2"));
  EXPECT_TRUE(holds(of_two_sizes, "a |u|"));
  const auto varied = distinct_entries(driven_by([](int i) { return std::sin(0.031 * i * i); }));
  EXPECT_EQ(varied.size(), dictionary(2.5).size());
}

// The search and the plant take the same numbers of a term: those beside its coefficients too.
TEST(Dictionary, GivesOfATermsProductsTheForceOfTheTerm) {
  const MotionRows motion = driven_by([](int i) { return std::sin(0.031 * i * i); });
  Term term;
  term.parts = parse_expression("a sign(v) |v|^n + b sin(kx) + c x cos(kx) + d u v", "");
  term.seen = motion.ranges();
  term.exponent = 0.4, term.period = 0.7;
  std::vector<double> sum(motion.points.size(), 0.0);
  double coefficient = 1.3;
  for (TermPart& part : term.parts) {
    part.coefficient = coefficient *= -0.6;
    const std::vector<double> values = values_of(entry_of(part, term), motion);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part.coefficient * values[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i], term.force(motion.points[i]), 1e-12) << i;
}

// A drag acts against the motion; what has the same direction either way is none.
TEST(TermMeaning, IsADragOnlyWhereItActsAgainstTheMotion) {
  const auto meaning = [](const char* expression) {
    return term_meaning(parse_expression(expression, "").front().powers, false);
  };
  for (const char* drag : {"a v", "a v^3", "a |v| v"}) EXPECT_EQ(meaning(drag).find("a drag"), 0U) << drag;
  EXPECT_EQ(meaning("a sign(v) |v|^n").find("a drag that grows with a power"), 0U);
  EXPECT_EQ(meaning("a cos(kx)").find("a force that repeats along the way"), 0U);
  for (const char* push : {"a v^2", "a |v|", "a |v|^n"})
    EXPECT_EQ(meaning(push).find("a force of one"), 0U) << push;
}

}  // namespace
}  // namespace biopsy::sim::gap
