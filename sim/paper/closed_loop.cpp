#include "sim/paper/closed_loop.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "robot/control/square_wave.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kTick_s = 1e-3;  // LabVIEW's cycle, IV.D

// Whether a force on plate A depends on its position.
bool acts_by_position(const PlantModel& model) {
  bool acts = !model.tissue.empty();
  for_each_present(model.effects, [&]<class E>(const E&) {
    if constexpr (requires { E::acts_by_position; }) acts = true;
  });
  return acts;
}

// The plant under its present weight, in the coordinates of the unloaded one.
class Stage {
 public:
  explicit Stage(const PlantModel& model) : model_(model), state_(at_rest(model)) {}

  void load(const LoadStep& put_on) {
    const double mass = put_on.mass;
    if (mass == loaded_) return;
    if (acts_by_position(model_)) {
      push_ = mass * model_.baseline.g;
      return;
    }
    const double sunk = (mass - loaded_) * model_.baseline.g / model_.baseline.k;
    const double before = model_.mass_A();
    model_.weight += mass - loaded_;
    if (put_on.speed > 0.0)  // what falls on plate A stays on it
      state_.motion.v += (mass - loaded_) / (before + mass - loaded_) * (-put_on.speed - state_.motion.v);
    loaded_ = mass;
    zero_ += sunk;
    shift(model_, state_, sunk);
  }
  void advance(double voltage) {
    state_ = step(model_, state_, {.voltage = voltage, .external_force = push_}, Seconds(kTick_s));
  }

  double reading_mm() const { return (displacement_reading(model_, state_) - zero_) * 1e3; }
  double plate_b_mm() const { return plate_b(model_, state_) * 1e3; }
  double deepest_mm() const { return (state_.x_max - zero_) * 1e3; }
  int layers() const { return layers_entered(model_, state_); }

 private:
  PlantModel model_;
  PlantState state_;
  double loaded_ = 0.0;  // kg
  double zero_ = 0.0;    // m
  double push_ = 0.0;    // N
};

LoadStep load_at(const std::vector<LoadStep>& loads, double time) {
  for (const LoadStep& load : loads)
    if (time >= load.from && time < load.to) return load;
  return {};
}

Course empty_course(std::size_t ticks) {
  Course course;
  for (std::vector<double>* of :
       {&course.time, &course.target, &course.plate_a, &course.plate_b, &course.amplitude})
    of->reserve(ticks);
  return course;
}

}  // namespace

LoopSettings paper_loop(double period) {
  return {.gains = {}, .highest = 10e3, .feed = {}, .period = period};
}

Course follow(const PlantModel& model, const LoopTask& task, const LoopSettings& settings) {
  const auto ticks = static_cast<std::uint32_t>(std::lround(task.seconds / kTick_s));
  Course course = empty_course(ticks);
  Stage stage(model);
  control::PiState loop;
  double fed = 0.0;  // V
  const auto every = std::max(1U, static_cast<std::uint32_t>(std::lround(settings.period / kTick_s)));
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    const double time = tick * kTick_s;
    stage.load(load_at(task.loads, time));
    const double target = task.target(time), reading = stage.reading_mm();
    if (settings.feed) {  // through the integral, so that one anti-windup holds for the sum
      const double feed = settings.feed(time);
      loop.integral += Volts(feed - std::exchange(fed, feed));
    }
    if (tick % every == 0)
      loop = control::pi_step(settings.gains, loop, Millimetres(target - reading), Volts(settings.highest));
    course.time.push_back(time);
    course.target.push_back(target);
    course.plate_a.push_back(reading);
    course.plate_b.push_back(stage.plate_b_mm());
    course.amplitude.push_back(loop.amplitude.value * 1e-3);
    stage.advance(loop.amplitude.value * control::polarity(tick));
  }
  course.deepest = stage.deepest_mm();
  course.layers = stage.layers();
  return course;
}

OfTime square_target(double low, double high, double frequency) {
  return [=](double time) {
    const double phase = time * frequency;
    return phase - std::floor(phase) < 0.5 ? low : high;
  };
}

OfTime sine_target(double low, double high, double frequency) {
  return [=](double time) {
    return low + 0.5 * (high - low) * (1.0 - std::cos(2.0 * std::numbers::pi * frequency * time));
  };
}

OfTime stair_target(std::vector<double> starts, std::vector<double> levels) {
  assert(starts.size() == levels.size());
  return [starts = std::move(starts), levels = std::move(levels)](double time) {
    const auto after = std::upper_bound(starts.begin(), starts.end(), time + 1e-9);
    return after == starts.begin() ? 0.0 : levels[static_cast<std::size_t>(after - starts.begin()) - 1];
  };
}

}  // namespace biopsy::sim::paper
