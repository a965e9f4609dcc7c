#include "tests/sim/gap/generator/hidden_programs.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace biopsy::hidden {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Amplitudes are shares of the run's top voltage. hz = 0: DC with the given sign. swing: sine on the
// amplitude.
struct ProgramSegment {
  double seconds, from, to;
  double hz = 2.0, sign = 1.0;
  double swing = 0.0, swing_hz = 0.5;
  double push = 0.0;  // N, down
};
using ProgramSegments = std::vector<ProgramSegment>;

// About 6 mm of stroke unloaded; heavier loads get what the amplifier can give.
double top_voltage(double weight) {
  const double load = (0.060 + weight) * 9.81;
  return std::min(3000.0, 2450.0 * std::sqrt(load / 1.08));
}

Program played(const ProgramSegments& pieces, double weight, double period, double length, Dice& dice) {
  Program out{period, weight, {}, {}};
  const double top = top_voltage(weight) * dice.between(0.97, 1.03);
  out.input.assign(static_cast<std::size_t>(0.4 * length / period), 0.0);
  out.push.assign(out.input.size(), 0.0);
  double phase = 0.0;
  for (const ProgramSegment& piece : pieces) {
    const double seconds = piece.seconds * length * dice.between(0.9, 1.1), level = dice.between(0.97, 1.03);
    const auto rows = static_cast<std::size_t>(seconds / period);
    for (std::size_t i = 0; i < rows; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(rows);
      const double t = static_cast<double>(i) * period;
      const double swing = piece.swing * std::sin(kTurn * piece.swing_hz * t);
      const double amplitude =
          std::min(3000.0, top * level * (piece.from + (piece.to - piece.from) * part + swing));
      phase += piece.hz * period;
      const double side = piece.hz == 0.0 ? piece.sign : (phase - std::floor(phase) < 0.5 ? 1.0 : -1.0);
      out.input.push_back(std::round(side * amplitude));  // the amplifier is set in whole volts
      out.push.push_back(piece.push);
    }
  }
  return out;
}

ProgramSegments ramp() {
  return {{1, 0, 0.6},       {6, 0.6, 1.0},    {3, 1.0, 1.0},   {6, 1.0, 0.62},
          {1, 0.62, 0.9, 0}, {3, 0.9, 0.9, 0}, {1, 0.9, 0.0, 0}};
}
ProgramSegments staircase() {
  ProgramSegments out{{0.5, 0.0, 0.65}};
  for (const double level : {0.65, 0.75, 0.85, 0.95, 1.0, 0.9, 0.8, 0.7}) out.push_back({2.0, level, level});
  out.push_back({4.0, 0.85, 0.85, 0.0, -1.0});
  out.push_back({2.0, 0.0, 0.0});
  return out;
}
ProgramSegments direct() {
  return {{1, 0, 0.9, 0},      {5, 0.9, 0.9, 0},       {1, 0.9, 0, 0},        {1, 0, 0},
          {1, 0, 0.95, 0, -1}, {5, 0.95, 0.95, 0, -1}, {1, 0.95, 0.3, 0, -1}, {1, 0.4, 0.7},
          {3, 0.8, 0.8},       {0.5, 0.8, 0.95, 0},    {5, 0.95, 0.95, 0}};
}
ProgramSegments sweep() {
  return {{1, 0.3, 0.75},   {5, 0.75, 0.75, 0.2}, {3, 0.85, 0.85, 0.5}, {3, 0.95, 0.95, 1},
          {3, 0.8, 0.8, 2}, {3, 0.95, 0.95, 5},   {3, 0.7, 0.7, 5},     {4, 0.85, 0.85, 0.5}};
}
ProgramSegments pushed() {
  return {{1, 0.2, 0.85},
          {2, 0.85, 0.85},
          {3, 0.85, 0.85, 2, 1, 0, 1, 0.10},
          {2, 0.95, 0.95, 2, 1, 0, 1, 0.10},
          {3, 0.95, 0.95},
          {2, 0.85, 0.85, 0, 1, 0, 1, 0.20},
          {2, 0.85, 0.85, 0},
          {1, 0.85, 0.1, 0},
          {1, 0.1, 0.6},
          {4, 0.6, 1.0, 2, 1, 0, 1, 0.05}};
}
ProgramSegments sine() {
  return {{2, 0.3, 0.8},
          {7, 0.82, 0.82, 2, 1, 0.15, 0.3},
          {6, 0.85, 0.85, 2, 1, 0.12, 1.0},
          {4, 0.8, 0.8, 1, 1, 0.18, 0.5}};
}
ProgramSegments triangle() {
  return {{2, 0.2, 0.65},  {5, 0.65, 1.0},  {4, 1.0, 0.75},
          {4, 0.75, 0.95}, {5, 0.95, 0.62}, {3, 0.9, 0.9, 0, 1}};
}
ProgramSegments jumps(Dice& dice) {
  ProgramSegments out{{0.5, 0.0, 0.6}};
  for (int i = 0; i < 14; ++i) {
    const double level = dice.between(0.58, 1.0);
    const bool direct = dice.uniform() < 0.3;
    const double sign = dice.uniform() < 0.5 ? -1.0 : 1.0;
    if (direct) out.push_back({dice.between(0.7, 1.4), 0.85 * level, 0.85 * level, 0.0, sign});
    if (!direct) out.push_back({dice.between(0.7, 2.2), level, level, dice.between(0.5, 4.0)});
  }
  return out;
}
ProgramSegments joined(ProgramSegments first, const ProgramSegments& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

struct Recipe {
  const char* name;
  double weight;  // kg
  ProgramSegments pieces;
};

using Wave = std::function<double(double t)>;

std::vector<std::pair<std::string, Wave>> waves(Dice& dice) {
  std::vector<double> phase, level;
  for (int i = 0; i < 40; ++i) phase.push_back(dice.uniform()), level.push_back(dice.between(-1.3, 1.3));
  const auto sum = [phase](double t, std::size_t first, double low, double high) {
    double force = 0.0;
    for (std::size_t i = 0; i < 9; ++i) {
      const double hz = low * std::pow(high / low, static_cast<double>(i) / 8.0);
      force += 0.28 * std::sin(kTurn * (hz * t + phase[first + i]));
    }
    return force;
  };
  const auto step = [level](double t) { return level[static_cast<std::size_t>(t / 0.8) % level.size()]; };
  const auto saw = [](double t, double hz) {
    return 1.0 - 4.0 * std::abs(hz * t - std::floor(hz * t) - 0.5);
  };
  return {{"multisine", [sum](double t) { return sum(t, 0, 0.2, 6.0); }},
          {"steps", step},
          {"chirp", [](double t) { return 0.7 * std::sin(kTurn * (0.3 * t + 0.15 * t * t)); }},
          {"triangle", [saw](double t) { return 1.4 * saw(t, 0.15); }},
          {"bursts", [saw](double t) { return saw(t, 0.25) > 0.0 ? 0.8 * std::sin(kTurn * 3.1 * t) : 0.0; }},
          {"multisine-2", [sum](double t) { return 0.7 * sum(t, 12, 0.5, 9.0); }},
          {"fast-triangle", [saw](double t) { return 1.1 * saw(t, 0.9); }},
          {"steps-2", [step](double t) { return 0.6 * step(1.7 * t + 3.0); }}};
}

}  // namespace

std::vector<NamedProgram> stage_programs(int count, double period, double length, Dice& dice) {
  std::vector<Recipe> recipes;
  if (count == 2)
    recipes = {{"mixed-50g", 0.050, joined(staircase(), pushed())},
               {"mixed-80g", 0.080, joined(direct(), sweep())}};
  if (count != 2)
    recipes = {{"ramp-50g", 0.050, ramp()},         {"staircase-20g", 0.020, staircase()},
               {"dc-80g", 0.080, direct()},         {"sweep-100g", 0.100, sweep()},
               {"push-50g", 0.050, pushed()},       {"jumps-130g", 0.130, jumps(dice)},
               {"triangle-80g", 0.080, triangle()}, {"sine-20g", 0.020, sine()},
               {"jumps-50g", 0.050, jumps(dice)}};
  std::vector<NamedProgram> out;
  for (const Recipe& recipe : recipes)
    if (static_cast<int>(out.size()) < count)
      out.push_back({recipe.name, played(recipe.pieces, recipe.weight, period, length, dice)});
  return out;
}

std::vector<NamedProgram> mechanism_programs(int count, double period, double length, Dice& dice) {
  std::vector<NamedProgram> out;
  for (const auto& [name, wave] : waves(dice)) {
    if (static_cast<int>(out.size()) == count) break;
    Program program{period, 0.0, {}, {}};
    const double seconds = length * dice.between(12.0, 18.0);
    for (double t = 0.0; t < seconds; t += period) program.input.push_back(1e-4 * std::round(1e4 * wave(t)));
    program.push.assign(program.input.size(), 0.0);
    out.push_back({name, std::move(program)});
  }
  return out;
}

}  // namespace biopsy::hidden
