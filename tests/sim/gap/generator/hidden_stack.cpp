#include "tests/sim/gap/generator/hidden_stack.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::hidden {
namespace {
constexpr double kEps0 = 8.8541878128e-12;
constexpr double kHeatSeconds = 12.0;
constexpr double kOnset = 30.0;      // V
constexpr double kFullHeat = 1.2e7;  // V^2/s of switching: 1.6 kV turned over twice 2.4 times a second
constexpr std::array<double, 2> kPlayWeight{0.65, 0.35}, kPlayRadius{1.0, 2.0};
constexpr std::array<double, 3> kCreepSeconds{0.8, 3.5, 14.0};
}  // namespace

double follow(double follower, double from, double to, double radius) {
  const double step = to - from;
  if (step == 0.0) return follower;
  const double slack = (step > 0.0 ? to - follower : follower - to) / radius;
  const double pull = std::clamp(slack, 0.0, 1.0);
  const double soft = std::pow(pull, 8);
  const double moved = follower + step * soft;
  return std::clamp(moved, to - radius, to + radius);
}

HiddenSupply::HiddenSupply(const StageNumbers& numbers, const HiddenPhysics& physics, std::uint64_t seed)
    : numbers_(numbers),
      p_(physics),
      dice_(seed ^ 0xE1EC),
      share_(numbers.K),
      leak_(numbers.tau),
      next_breakdown_(0.0) {
  next_breakdown_ = dice_.between(0.5, 4.0);
}

double HiddenSupply::limited(double volts) const {
  if (p_.saturation <= 0.0) return volts;
  return volts / std::pow(1.0 + std::pow(std::abs(volts / p_.saturation), p_.saturation_power),
                          1.0 / p_.saturation_power);
}

void HiddenSupply::zip(double rise) {
  if (p_.film_growth <= 0.0) return;
  const double before = share_;
  share_ = numbers_.K / (1.0 + (1.0 - numbers_.K) * p_.film_growth * rise);
  leak_ = numbers_.tau * numbers_.K / share_;
  output_ *= share_ / before;
}

void HiddenSupply::command(double volts) {
  wanted_ = limited(volts);
  if (p_.amplifier_time > 0.0) return;
  const double jump = share_ * (wanted_ - applied_);
  heat_ += p_.heating > 0.0 ? jump * jump / kFullHeat / kHeatSeconds : 0.0;
  output_ += jump;
  applied_ = wanted_;
}

void HiddenSupply::advance(double t, double h) {
  const double a = 0.5 * h / leak_;
  double rise = 0.0;
  if (p_.amplifier_time > 0.0) {
    const double target = (wanted_ - applied_) / p_.amplifier_time;
    rise = h * p_.amplifier_slew * std::tanh(target / p_.amplifier_slew);
    applied_ += rise;
  }
  output_ = ((1.0 - a) * output_ + share_ * rise) / (1.0 + a);
  if (p_.trap_capture > 0.0) trapped_ += h * (p_.trap_capture * output_ - p_.trap_release * trapped_);
  heat_ *= 1.0 - h / kHeatSeconds;
  if (p_.breakdown > 0.0 && t > next_breakdown_) {
    if (std::abs(output_) > 1300.0) output_ *= 1.0 - p_.breakdown;
    next_breakdown_ = t + dice_.between(0.2, 4.0);
  }
}

double HiddenSupply::pressure() const {
  double acting = output_ - trapped_;
  if (p_.dead_band > 0.0) {  // softplus
    const double above = (std::abs(acting) - p_.dead_band) / kOnset;
    acting = std::copysign(kOnset * (above > 30.0 ? above : std::log1p(std::exp(above))), acting);
  }
  const double side = 1.0 + (p_.asymmetry != 0.0 ? p_.asymmetry * std::tanh(acting / 20.0) : 0.0);
  const double warm = 1.0 - p_.heating * heat_ / (1.0 + heat_);
  const double weak =
      p_.weak_field != 0.0 ? std::exp(-p_.weak_field * std::log(std::abs(acting) / 1000.0 + 1e-9)) : 1.0;
  return weak * warm * side * numbers_.eps_film * kEps0 * acting * acting /
         (2.0 * numbers_.d_film * numbers_.d_film);
}

HiddenFilms::HiddenFilms(const StageNumbers& numbers, const HiddenPhysics& physics)
    : floor_(numbers.H_0), peak_(numbers.H_0), last_(numbers.H_0), p_(physics) {
  play_.fill(numbers.H_0);
}

double HiddenFilms::aim(double equilibrium) const {
  double target = equilibrium;
  if (p_.zip_ledge > 0.0) {  // smooth stairs
    const double turn = 2.0 * 3.14159265358979 * (equilibrium - floor_) / p_.zip_ledge;
    target -= 0.9 * p_.zip_ledge / (2.0 * 3.14159265358979) * std::sin(turn);
  }
  if (p_.zip_radius > 0.0) {
    target = 0.0;
    for (std::size_t i = 0; i < play_.size(); ++i)
      target += kPlayWeight[i] * follow(play_[i], last_, equilibrium, kPlayRadius[i] * p_.zip_radius);
  }
  target += p_.set_share * std::max(0.0, peak_ - equilibrium);
  for (const double part : creep_) target += part;
  return std::max(floor_, target);
}

void HiddenFilms::remember(double equilibrium, double height, double h) {
  if (p_.zip_radius > 0.0)
    for (std::size_t i = 0; i < play_.size(); ++i)
      play_[i] = follow(play_[i], last_, equilibrium, kPlayRadius[i] * p_.zip_radius);
  last_ = equilibrium;
  peak_ = std::max(height, peak_ - h * (peak_ - height) / p_.set_time);
  if (p_.creep_share > 0.0)
    for (std::size_t i = 0; i < creep_.size(); ++i)
      creep_[i] += h / kCreepSeconds[i] * (p_.creep_share / 3.0 * (equilibrium - floor_) - creep_[i]);
}

}  // namespace biopsy::hidden
