// Figures of merit of a closed-loop run, and the definition of "settled".
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sim/paper/closed_loop.hpp"

namespace biopsy::sim::paper {

// A tick is settled from kSettling after the target's last jump (more than kJump within a tick) or after the
// loop was closed. A sine is thus settled after its beginning, a square wave faster than 0.25 Hz never.
// IV.E says that the stage recovers within 1 s: after twice that nothing of the edge is left, and no shorter
// window follows from the text. Rows are shown for kOtherSettling too.
inline constexpr double kSettling = 2.0;                          // s
inline constexpr std::array<double, 2> kOtherSettling{1.5, 3.0};  // s
inline constexpr double kJump = 0.1;                              // mm

std::vector<bool> settled(const Course& course, double settling = kSettling);

// Of target - plate A, over everything and over settled ticks; the latter is NaN where nothing settles. mm
double rmse(const Course& course);
double rmse_settled(const Course& course, double settling = kSettling);

// Of target - plate A where low <= target < high. mm
double rmse_between(const Course& course, double low, double high);

// A jump of the target and what follows until the next. Ticks; mm.
struct Edge {
  std::size_t at = 0, until = 0;
  double from = 0.0, to = 0.0;

  bool rises() const { return to > from; }
};
std::vector<Edge> edges(const Course& course);

// How far plate A goes beyond the new target, in mm (negative: it does not get there); and how long it takes
// for 90 % of the way, in s (the whole time where it does not get there).
double beyond_target(const Course& course, const Edge& edge);
double travel_time(const Course& course, const Edge& edge);

// Mean travel time of the rising or the falling edges. s
double mean_travel(const Course& course, bool rising);

// Share of a panel's width that a line of its curves covers: a shift along time below that is not seen.
inline constexpr double kLineShare = 0.005;  // 0.4 mm of 8 cm

// By how much falling edges take longer than rising ones, over what a reader sees, less 1: positive where the
// lag shows in a panel as long as the course.
double visible_lag(const Course& course);

// Largest overshoot of rising edges, % of the target; and how far plate A falls below the target of falling
// ones, % of the step (0 where it stays above).
double overshoot_percent(const Course& course);
double undershoot_percent(const Course& course);

// Response to the target at one frequency, from `from` on: gain 1 and lag 0 for perfect tracking.
struct Transfer {
  double gain = 0.0;
  double lag_degrees = 0.0;  // positive: late
};
Transfer transfer(const Course& course, double frequency, double from);

struct Span {
  double low = 0.0, high = 0.0;

  double width() const { return high - low; }
};
// Of `values` between two times. The course gives the times.
Span span(const Course& course, const std::vector<double>& values, double from, double to);
double mean_between(const Course& course, const std::vector<double>& values, double from, double to);

}  // namespace biopsy::sim::paper
