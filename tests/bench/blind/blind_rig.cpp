#include "tests/bench/blind/blind_rig.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace biopsy::blind {
namespace {

constexpr double kGravity = 9.81, kVacuum = 8.8541878128e-12, kLongestStep = 50e-6,
                 kTurn = 2 * std::numbers::pi;

int steps_in(double period) {
  return static_cast<int>(std::ceil(period / kLongestStep - 1e-9));
}

double approach(double from, double to, double h, double time) {
  return to + (from - to) * std::exp(-h / time);
}

// Springs in parallel, each of which slides at its own force.
class Sliders {
 public:
  double force(double move, double spring, double level) {
    constexpr std::array kShares{0.4, 0.8, 1.2, 1.6};
    double sum = 0.0;
    for (std::size_t i = 0; i < kShares.size(); ++i) {
      const double most = kShares[i] * level / 4.0;
      held_[i] = std::clamp(held_[i] + spring / 4.0 * move, -most, most);
      sum += held_[i];
    }
    return sum;
  }

 private:
  std::array<double, 4> held_{};
};

// A mass and all that acts on it but its spring.
class Carriage {
 public:
  Carriage(const Extra& extra, double mass, double loss) : e_(extra), mass_(mass + extra.mass), loss_(loss) {}

  double x = 0.0, v = 0.0;

  double middle(double h) const { return x + 0.5 * h * v; }

  // `force`: of the spring and the drive, at middle(h).
  void step(double t, double force, double acting, double h) {
    const double at = middle(h);
    force += smooth_forces(t, at, acting, h);
    const double half = 0.5 * h * loss_ / mass_;
    double free = ((1.0 - half) * v + h * force / mass_) / (1.0 + half);
    const double impulse = h * dry_force(at, free, acting) / mass_;
    free = std::abs(free) <= impulse ? 0.0 : free - std::copysign(impulse, free);
    v = free;
    x = at + 0.5 * h * v;
    carried_ = std::clamp(carried_, x - 0.5 * e_.play, x + 0.5 * e_.play);
  }

  double carried() const { return carried_; }

 private:
  double smooth_forces(double t, double at, double acting, double h) {
    double out = -e_.push - e_.drag * v * std::abs(v) + e_.wave * std::sin(kTurn * e_.wave_hz * t + 1.1);
    if (e_.stop_spring > 0.0 && at > e_.stop) out -= std::max(0.0, e_.stop_spring * (at - e_.stop) + 3.0 * v);
    if (e_.slider_force > 0.0) out -= sliders_.force(h * v, e_.slider_spring, e_.slider_force);
    if (e_.law) out += e_.law(at, v, acting);
    if (e_.memory_spring > 0.0) {
      far_end_ = approach(far_end_, at, h, e_.memory_time);
      out -= e_.memory_spring * (at - far_end_);
    }
    return out - tissue(at, h);
  }

  double tissue(double at, double h) {
    double out = 0.0;
    if (e_.rupture > 0.0 && at > e_.surface) {
      const double deep = (at - e_.surface) / e_.bulge;
      open_ = open_ || deep >= 1.0;
      falling_ = open_ ? approach(falling_, e_.after, h, 5e-3) : e_.rupture;
      // Once open, the tip cuts on every way in, and nothing holds it on the way out.
      if (!open_)
        out += e_.rupture * deep * deep;
      else if (v > 0.0)
        out += falling_ * std::min(1.0, v / 0.5e-3);
    }
    if (e_.dragged > 0.0) {
      const double inserted = std::max(0.0, at - e_.grip_from);
      far_tissue_ = approach(far_tissue_, inserted, h, e_.dragged_time);
      out += e_.dragged * (inserted - far_tissue_);
    }
    return out;
  }

  double dry_force(double at, double speed, double acting) const {
    const double slow = speed / e_.static_speed;
    double out = e_.friction;
    if (e_.static_friction > 0.0) out += (e_.static_friction - e_.friction) * std::exp(-slow * slow);
    out += e_.grip * std::max(0.0, at - e_.grip_from);
    if (e_.rub) out += std::max(0.0, e_.rub(at, acting));
    return out;
  }

  const Extra& e_;
  double mass_, loss_;
  double carried_ = 0.0, far_end_ = 0.0, far_tissue_ = 0.0, falling_ = 0.0;
  bool open_ = false;
  Sliders sliders_;
};

// Readings from the motion of every step.
std::vector<double> read(const std::vector<double>& motion, const Extra& e, const Drive& drive, int steps) {
  std::vector<double> sums(1, 0.0), out;
  for (const double x : motion) sums.push_back(sums.back() + x);
  const auto window = static_cast<std::size_t>(e.average / drive.period * steps);
  for (std::size_t row = 0; row < drive.input.size(); ++row) {
    const std::size_t now = row * static_cast<std::size_t>(steps);
    double x = motion[now];
    if (window > 0) {
      const std::size_t first = now + 1 > window ? now + 1 - window : 0;
      x = (sums[now + 1] - sums[first]) / static_cast<double>(window);  // at rest at 0 before
    }
    out.push_back((1.0 + e.scale) * x + e.offset + e.drift * drive.period * static_cast<double>(row));
  }
  return out;
}

// Amplifier, leakage and charge in the films: what pulls.
class Films {
 public:
  Films(const StageRig& rig, const Extra& e) : rig_(rig), e_(e) {}

  void step(double command, double h) {
    if (e_.limit > 0.0) {  // bends towards the limit without a corner
      const double ratio = std::abs(command) / e_.limit;
      command /= std::pow(1.0 + std::pow(ratio, 14.0), 1.0 / 14.0);
    }
    const double before = applied_;
    applied_ = e_.amplifier_time > 0.0 ? approach(applied_, command, h, e_.amplifier_time) : command;
    acting_ = approach(acting_ + rig_.gain * (applied_ - before), 0.0, h, rig_.leak_time);
    if (e_.trapped > 0.0) screen_ = approach(screen_, e_.trapped * acting_, h, e_.trapped_time);
  }

  double pull() const {
    const double u = acting_ - screen_;
    return std::max(0.0, std::abs(u * (1.0 + (u > 0.0 ? e_.one_sided : -e_.one_sided))) - e_.threshold);
  }

 private:
  const StageRig& rig_;
  const Extra& e_;
  double applied_ = 0.0, acting_ = 0.0, screen_ = 0.0;
};

// (18) and (19) of the paper for a load and a voltage on the films.
double balanced_height(const StageRig& rig, double load, double volts) {
  const double pressure = 0.5 * rig.permittivity * kVacuum * std::pow(volts / rig.film, 2);
  if (pressure <= 0.0) return rig.rest_height;
  const double s = load / (rig.width * pressure), q = std::numbers::pi * rig.volume / rig.width;
  return std::max(rig.rest_height, 2.0 / std::numbers::pi * (std::hypot(s, std::sqrt(q)) - s));
}

// Height of a pouch, and what plate B makes of it.
class Pouches {
 public:
  Pouches(const StageRig& rig, const Extra& e) : rig_(rig), e_(e), height_(rig.rest_height), aim_(height_) {}

  void step(double load, double volts, double h) {
    if (e_.film_loss > 0.0) volts = std::max(0.0, volts - e_.film_loss * stuck_);
    const double balanced = balanced_height(rig_, load, volts);
    aim_ = std::max(rig_.rest_height,
                    std::clamp(aim_, balanced - 0.5 * e_.play_height, balanced + 0.5 * e_.play_height));
    const double before = height_, time = rig_.oil_time * (aim_ < height_ ? 1.0 + e_.slow_fall : 1.0);
    height_ = approach(height_, aim_, h, time);
    stuck_ = std::clamp(stuck_ + (height_ - before) / 15e-6, -1.0, 1.0);
    const double rise = height_ - rig_.rest_height;
    largest_ = std::max(rise, approach(largest_, 0.0, h, e_.set_time));
    crept_ = approach(crept_, e_.creep * rise, h, e_.creep_time);
  }

  double plate_b() const {
    const double rise = height_ - rig_.rest_height;
    return rig_.pouches * (rise + crept_ + e_.set * (largest_ - rise));
  }

 private:
  const StageRig& rig_;
  const Extra& e_;
  double height_, aim_, stuck_ = 0.0, largest_ = 0.0, crept_ = 0.0;
};

}  // namespace

Seen ride_stage(const StageRig& rig, const Extra& e, const Drive& drive) {
  const int steps = steps_in(drive.period);
  const double h = drive.period / steps, carried = (rig.fixture + drive.weight) * kGravity;
  Films films(rig, e);
  Pouches pouches(rig, e);
  Carriage plate(e, rig.fixture + drive.weight, rig.slide_loss);
  const double heavier = e.mass * kGravity;
  std::vector<double> motion;
  Seen out;
  double spring = carried;
  for (std::size_t row = 0; row < drive.input.size(); ++row) {
    out.plate_b.push_back(pouches.plate_b());
    for (int i = 0; i < steps; ++i) {
      motion.push_back(plate.carried());
      const double before = pouches.plate_b();
      films.step(drive.input[row], h);
      pouches.step(spring + rig.plate_b * kGravity, films.pull(), h);
      const double now = pouches.plate_b(), bent = 0.5 * (before + now) - plate.middle(h);
      spring = std::max(0.0, carried + heavier + rig.spring * bent + e.cubic * bent * bent * bent +
                                 rig.spring_loss * ((now - before) / h - plate.v));
      const double t = (static_cast<double>(row) * steps + i) * h;
      plate.step(t, spring - carried - heavier, films.pull(), h);
    }
  }
  out.displacement = read(motion, e, drive, steps);
  return out;
}

Seen ride_mass(const MassRig& rig, const Extra& e, const Drive& drive) {
  const int steps = steps_in(drive.period);
  const double h = drive.period / steps;
  Carriage mass(e, rig.mass, rig.loss);
  std::vector<double> motion;
  for (std::size_t row = 0; row < drive.input.size(); ++row)
    for (int i = 0; i < steps; ++i) {
      motion.push_back(mass.carried());
      const double at = mass.middle(h);
      mass.step((static_cast<double>(row) * steps + i) * h,
                drive.input[row] - rig.spring * at - e.cubic * at * at * at, drive.input[row], h);
    }
  return {.displacement = read(motion, e, drive, steps), .plate_b = {}};
}

double voltage_for(const StageRig& rig, double height, double weight) {
  const double tall = rig.rest_height + height / rig.pouches;
  const double s = (std::numbers::pi * rig.volume / rig.width - std::pow(0.5 * std::numbers::pi * tall, 2)) /
                   (std::numbers::pi * tall);
  const double load = (rig.fixture + rig.plate_b + weight) * kGravity;
  const double pressure = load / (rig.width * std::max(s, 1e-6));
  return rig.film * std::sqrt(2.0 * pressure / (rig.permittivity * kVacuum)) / rig.gain;
}

}  // namespace biopsy::blind
