// Beyond the paper: other controllers for low targets, falling edges and the return to zero, and their
// voltage. Each beside the paper's PI loop, on the same stage, the same task and the same 8 kV.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/paper/feed_forward.hpp"
#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/loop_panels.hpp"
#include "sim/paper/figures/loop_scores.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/paper_targets.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kSeconds = 2.0 / kSlowest;
constexpr double kFall = 1.0 / kSlowest;  // s, the square wave's first falling edge
constexpr double kLow = 2.0;              // mm, below which a target is low, as in Fig. 9b
constexpr double kBias = 0.8;             // mm of lift taken as depth 0: just above what friction holds
constexpr double kLift = 5.0;             // s, for the lift before the task
constexpr double kTick = 1e-3;            // s
constexpr double kSpeed = 4.0;            // mm/s, of a limited target
constexpr double kUp = 1.0, kDown = 8.0, kEnd = 20.0;  // s: to 8 mm and back to 0
constexpr double kMisjudged =
    1.1;  // factor on the permittivity: feed-forward from a model with an error of 10 %

// One controller on its three tasks.
struct Outcome {
  Course sine, square, back;
};

struct Controller {
  bool feed = false;
  double speed = 0.0;  // mm/s; 0: not limited
  double bias = 0.0;   // mm
};

// The lift first, then the task.
OfTime lifted(const OfTime& target, double bias) {
  return [=](double time) { return bias + (time < kLift ? 0.0 : target(time - kLift)); };
}

// Removes the first kLift.
void begin_after_lift(Course& course) {
  const auto ticks = static_cast<std::ptrdiff_t>(std::lround(kLift / kTick));
  for (std::vector<double>* values :
       {&course.time, &course.target, &course.plate_a, &course.plate_b, &course.amplitude})
    values->erase(values->begin(), values->begin() + ticks);
  for (double& time : course.time) time -= kLift;
}

Course driven(const PlantModel& stage, const PlantModel& model, OfTime target, double seconds,
              const Controller& how) {
  if (how.bias > 0.0) {
    target = lifted(target, how.bias);
    seconds += kLift;
  }
  if (how.speed > 0.0) target = rate_limited(target, how.speed, seconds);
  LoopSettings settings;
  if (how.feed) settings.feed = feed_forward(model, target, seconds);
  Course course = follow(stage, {.target = target, .seconds = seconds, .loads = {}}, settings);
  if (how.bias > 0.0) begin_after_lift(course);
  for (std::vector<double>* depths : {&course.target, &course.plate_a, &course.plate_b})
    for (double& depth : *depths) depth -= how.bias;
  return course;
}

Outcome drive(const PlantModel& stage, const PlantModel& model, const Controller& how) {
  return {driven(stage, model, sine_target(kSineLow, kSineHigh, kSlowest), kSeconds, how),
          driven(stage, model, square_target(kSquareLow, kSquareHigh, kSlowest), kSeconds, how),
          driven(stage, model, stair_target({kUp, kDown}, {kSineHigh, 0.0}), kEnd, how)};
}

double low_rmse(const Outcome& way) {
  return rmse_between(way.sine, kSineLow, kLow);
}

// Lower bound for any controller: 0 V from the falling edge on.
Course free_fall(const PlantModel& stage) {
  constexpr double nothing = -1e6;  // V, feed-forward that saturates the loop at 0
  LoopSettings settings;
  settings.feed = [](double time) { return time < kFall ? 0.0 : nothing; };
  return follow(
      stage, {.target = square_target(kSquareLow, kSquareHigh, kSlowest), .seconds = kSeconds, .loads = {}},
      settings);
}

// Delay of the falling edge: the area between plate A and its target, over the height of the step. s
double delay(const Course& square, const std::vector<double>& target) {
  const double height = kSquareHigh - kSquareLow;
  double area = 0.0;
  for (std::size_t k = 0; k < square.time.size(); ++k)
    if (square.time[k] >= kFall && square.time[k] < kFall + 0.5 / kSlowest)
      area += std::max(0.0, square.plate_a[k] - target[k]) * 1e-3;
  return area / height;
}

double delay(const Course& square) {
  return delay(square, square.target);
}

// Delay against the step, where the limited target moves more slowly.
double delay_behind_step(const Course& square) {
  const OfTime step = square_target(kSquareLow, kSquareHigh, kSlowest);
  std::vector<double> target;
  target.reserve(square.time.size());
  for (const double time : square.time) target.push_back(step(time));
  return delay(square, target);
}

double left(const Outcome& way) {
  return mean_between(way.back, way.back.plate_a, kEnd - 1.0, kEnd);
}

// kV
struct Cost {
  double sine, square, rest;
};

Cost cost_of(const Outcome& way) {
  return {span(way.sine, way.sine.amplitude, kSettling, kSeconds).high,
          span(way.square, way.square.amplitude, kSettling, kSeconds).high,
          mean_between(way.back, way.back.amplitude, kEnd - 1.0, kEnd)};
}

std::string cost(const Outcome& paper, const Outcome& way) {
  const Cost of_pi = cost_of(paper), of_way = cost_of(way);
  return fmt::format(
      "needs at most {:.1f} kV on the sine (the PI loop {:.1f}), {:.1f} kV on the square wave ({:.1f}), "
      "{:.1f} "
      "kV at rest in 0 ({:.1f}), within 8 kV",
      of_way.sine, of_pi.sine, of_way.square, of_pi.square, of_way.rest, of_pi.rest);
}

void add_rows(PaperFigure& figure, const std::string& name, const Outcome& paper, const Outcome& way,
              const std::string& note) {
  const std::string all = note + "; " + cost(paper, way);
  figure.rows.push_back(shown_row({"beyond", "sine, RMSE at targets below 2 mm: " + name, "mm"},
                                  low_rmse(paper), low_rmse(way), all));
  figure.rows.push_back(shown_row({"beyond", "sine, RMSE over everything: " + name, "mm"}, rmse(paper.sine),
                                  rmse(way.sine), all));
  figure.rows.push_back(shown_row({"beyond", "square wave, RMSE over settled windows: " + name, "mm"},
                                  rmse_settled(paper.square), rmse_settled(way.square), all));
  figure.rows.push_back(shown_row({"beyond", "square wave, delay of the falling edge: " + name, "s"},
                                  delay(paper.square), delay_behind_step(way.square), all));
  figure.rows.push_back(
      shown_row({"beyond", "left 12 s after the return to 0: " + name, "mm"}, left(paper), left(way), all));
}

FigurePanel beside(std::string title, const Course& paper, std::string name, const Course& course,
                   double until) {
  FigurePanel panel = displacement_panel(std::move(title), paper, {0.0, until});
  panel.curves[1].name = "PI";
  panel.curves.push_back(drawn(std::move(name), course, course.plate_a, {0.0, until}));
  fit_height(panel);
  return panel;
}

}  // namespace

PaperFigure beyond(const PaperModel& model) {
  PlantModel stage = model.stage;
  stage.weight = kWeight;
  PlantModel wrong = stage;
  wrong.baseline.eps_film *= kMisjudged;
  const Outcome paper = drive(stage, stage, {});
  const Outcome fed = drive(stage, stage, {.feed = true});
  const Outcome off = drive(stage, wrong, {.feed = true});
  const Outcome limited = drive(stage, stage, {.feed = true, .speed = kSpeed});
  const Outcome biased = drive(stage, stage, {.feed = true, .bias = kBias});
  PaperFigure figure{
      "beyond",
      "Other controllers for low targets, falling edges and the return to zero",
      "Other controllers of the same stage, beside the paper's PI loop, all within this robot's 8 kV (Fig. 9 "
      "uses the amplifier's 10 kV); the notes give the voltage that each needs.",
      {},
      {}};
  figure.panels = {beside("sine", paper.sine, "PI and feed-forward", fed.sine, kSeconds),
                   beside("square wave", paper.square, "target limited", limited.square, kSeconds),
                   beside("return to zero", paper.back, "above a bias", biased.back, kEnd)};
  add_rows(figure, "feed-forward", paper, fed,
           "inverse of the film's static curve, with hysteresis, added to PI");
  add_rows(figure, "feed-forward, permittivity off by 10 %", paper, off,
           "the same from a model with that error");
  add_rows(figure, fmt::format("target limited to {:.0f} mm/s", kSpeed), paper, limited,
           fmt::format("feed-forward; RMSE is against the limited target, where 6 mm take {:.1f} s, delay "
                       "against the step: a limited target is followed closely, with a delay",
                       6.0 / kSpeed));
  figure.rows.push_back(shown_row(
      {"beyond", fmt::format("square wave, delay behind a target of {:.0f} mm/s itself", kSpeed), "s"},
      delay(paper.square), delay(limited.square), "delay of plate A behind the limited target"));
  add_rows(
      figure, fmt::format("above a bias of {:.1f} mm", kBias), paper, biased,
      fmt::format(
          "feed-forward; depth 0 is {:.1f} mm of lift, reached before the task and taken from the stroke",
          kBias));
  figure.rows.push_back(shown_row(
      {"beyond", "square wave, delay of the falling edge: free fall", "s"}, delay(paper.square),
      delay(free_fall(stage)), "0 V from the edge on: the stack can only push, so no controller is faster"));
  return figure;
}

}  // namespace biopsy::sim::paper
