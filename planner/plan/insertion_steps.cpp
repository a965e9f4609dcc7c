#include "planner/plan/insertion_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <string>

namespace biopsy::planner {
namespace {

// A tissue boundary the needle comes near on its way to the target.
struct Boundary {
  Millimetres depth;
  std::string name;  // "muscle | gap"
};

// A stretch of the path in which the needle goes slowly: one boundary, or several with no room for a stop
// between.
struct Crossing {
  Millimetres from, to;
};

// Where a step ends and why it ends there.
struct Stop {
  StepKind kind;
  Millimetres depth;
  std::string why;
};

// Depths are compared with this slack, so that 2.3 and 2.0 + 0.3 are one depth.
constexpr Millimetres kSlack{1e-6};

std::vector<Boundary> boundaries_near_path(const std::vector<Layer>& layers, Millimetres target) {
  std::vector<Boundary> boundaries;
  for (std::size_t n = 1; n < layers.size(); ++n)
    if (layers[n].from - kStopShort < target - kSlack)
      boundaries.push_back({layers[n].from, layers[n - 1].name + " | " + layers[n].name});
  return boundaries;
}

std::vector<Crossing> crossings_of(const std::vector<Boundary>& boundaries, Millimetres target) {
  std::vector<Crossing> crossings;
  for (const Boundary& boundary : boundaries) {
    const Millimetres from = boundary.depth - kStopShort, to = boundary.depth + kStopBehind;
    if (!crossings.empty() && from - crossings.back().to < kStepMin - kSlack)
      crossings.back().to = to;
    else
      crossings.push_back({from, to});
  }
  for (Crossing& crossing : crossings) {
    if (crossing.from < kStepMin) crossing.from = Millimetres(0.0);
    if (crossing.to > target - kStepMin + kSlack) crossing.to = target;
  }
  return crossings;
}

std::string list_of(const std::vector<Boundary>& boundaries, Millimetres from, Millimetres to) {
  std::string text;
  for (const Boundary& boundary : boundaries)
    if (boundary.depth >= from - kSlack && boundary.depth <= to + kSlack)
      text +=
          fmt::format("{}{} at {:.2f} mm", text.empty() ? "" : " and ", boundary.name, boundary.depth.value);
  return text;
}

std::vector<Stop> stops_at_crossings(const std::vector<Crossing>& crossings,
                                     const std::vector<Boundary>& boundaries, Millimetres target) {
  std::vector<Stop> stops;
  for (const Crossing& crossing : crossings) {
    const std::string names = list_of(boundaries, crossing.from, crossing.to);
    if (crossing.from.value > 0.0 && target - crossing.from > kStepMin - kSlack)
      stops.push_back({StepKind::Approach, crossing.from,
                       "stop short of " + list_of(boundaries, crossing.from, crossing.from + kStopShort)});
    if (crossing.to < target) stops.push_back({StepKind::Cross, crossing.to, "stop behind " + names});
  }
  return stops;
}

// A waypoint takes the place of a stop too close to it, except inside a crossing: a stop on the safe side of
// a boundary is kept.
void add_waypoint(std::vector<Stop>& stops, Millimetres waypoint, const std::vector<Crossing>& crossings) {
  const bool crossing = std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& span) {
    return waypoint > span.from + kSlack && waypoint < span.to - kSlack;
  });
  const Millimetres reach = crossing ? kSlack : kStepMin - kSlack;
  std::erase_if(stops, [&](const Stop& stop) {
    return stop.kind != StepKind::Waypoint && stop.depth > waypoint - reach && stop.depth < waypoint + reach;
  });
  const auto place =
      std::find_if(stops.begin(), stops.end(), [&](const Stop& stop) { return stop.depth > waypoint; });
  const Stop added{StepKind::Waypoint, waypoint, "asked for on the way"};
  stops.insert(place, added);
}

const Layer& layer_of(const std::vector<Layer>& layers, Millimetres target) {
  const auto found =
      std::find_if(layers.begin(), layers.end(), [&](const Layer& layer) { return target < layer.to; });
  assert(found != layers.end());
  return *found;
}

InsertionStep stage_from(const Stop& stop, Millimetres start, const std::vector<Crossing>& crossings,
                         const std::vector<Boundary>& boundaries, const Pace& pace,
                         const NominalModel& model) {
  const bool slow = std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& span) {
    return start < span.to - kSlack && stop.depth > span.from + kSlack;
  });
  InsertionStep step{.kind = stop.kind,
                     .depth = stop.depth,
                     .speed = slow ? pace.crossing : pace.speed,
                     .v_max = model.drive_limit(stop.depth),
                     .dwell = pace.dwell,
                     .image_confirms = stop.kind == StepKind::Waypoint || stop.kind == StepKind::Target,
                     .why = stop.why};
  if (const std::string crossed = list_of(boundaries, start, stop.depth);
      slow && stop.kind != StepKind::Cross)
    step.why += crossed.empty() ? ", slowly: a boundary is near" : "; slowly through " + crossed;
  return step;
}

}  // namespace

std::vector<InsertionStep> plan_steps(const std::vector<Layer>& layers, Millimetres target,
                                      const std::vector<Millimetres>& waypoints, Staging staging,
                                      const Pace& pace, const NominalModel& model) {
  assert(std::is_sorted(waypoints.begin(), waypoints.end()) && target.value > 0.0);
  const Layer& goal = layer_of(layers, target);
  const std::vector<Boundary> boundaries = boundaries_near_path(layers, target);
  const std::vector<Crossing> crossings = crossings_of(boundaries, target);

  std::vector<Stop> stops;
  if (staging == Staging::Automatic) stops = stops_at_crossings(crossings, boundaries, target);
  for (const Millimetres waypoint : waypoints) add_waypoint(stops, waypoint, crossings);
  stops.push_back({StepKind::Target, target, "target in " + goal.name});

  std::vector<InsertionStep> steps;
  Millimetres start{0.0};
  for (const Stop& stop : stops) {
    steps.push_back(stage_from(stop, start, crossings, boundaries, pace, model));
    start = stop.depth;
  }
  // The last stop in front of the target's layer is where an image can still change the outcome.
  const auto last_before = std::find_if(steps.rbegin() + 1, steps.rend(), [&](const InsertionStep& step) {
    return step.depth <= goal.from + kSlack;
  });
  if (last_before != steps.rend()) last_before->image_confirms = true;
  return steps;
}

}  // namespace biopsy::planner
