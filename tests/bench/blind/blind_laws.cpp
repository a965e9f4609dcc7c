#include "tests/bench/blind/blind_laws.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::blind {

double between(Random& random, double low, double high) {
  return low + (high - low) * std::generate_canonical<double, 53>(random);
}

double either_sign(Random& random, double low, double high) {
  const double size = between(random, low, high);
  return random() % 2 ? size : -size;
}

namespace {

void add_friction(Extra& e, Random& r, const Sizes& s) {
  e.friction = between(r, 0.02, 0.12) * s.force;
}

void add_stiction(Extra& e, Random& r, const Sizes& s) {
  e.friction = between(r, 0.03, 0.08) * s.force;
  e.static_friction = between(r, 1.5, 2.2) * e.friction;
  e.static_speed = between(r, 0.02, 0.08) * s.speed;
}

void add_drag(Extra& e, Random& r, const Sizes& s) {
  e.drag = between(r, 0.6, 2.5) * s.force / (s.speed * s.speed);
}

void add_cubic(Extra& e, Random& r, const Sizes& s) {
  e.cubic = between(r, 0.1, 0.6) * s.spring / (s.stroke * s.stroke);
}

void add_sliders(Extra& e, Random& r, const Sizes& s) {
  e.slider_force = between(r, 0.1, 0.3) * s.force;
  e.slider_spring = e.slider_force / (between(r, 0.05, 0.2) * s.stroke);
}

void add_push(Extra& e, Random& r, const Sizes& s) {
  e.push = either_sign(r, 0.03, 0.15) * s.force;
}

void add_wave(Extra& e, Random& r, const Sizes& s) {
  e.wave = between(r, 0.02, 0.08) * s.force;
  e.wave_hz = between(r, 0.2, 1.6);
}

void add_stop(Extra& e, Random& r, const Sizes& s) {
  e.stop = between(r, 0.45, 0.65) * s.stroke;
  e.stop_spring = between(r, 10.0, 40.0) * s.spring;
}

void add_mass(Extra& e, Random& r, const Sizes& s) {
  e.mass = either_sign(r, 0.08, 0.25) * s.mass;
}

void add_play(Extra& e, Random& r, const Sizes& s) {
  e.play = between(r, 0.015, 0.06) * s.stroke;
}

void add_valve(Extra& e, Random& r, const Sizes& s) {
  const double c = between(r, 0.2, 0.5) * s.force / s.speed;
  e.law = [=](double, double v, double) { return v < 0.0 ? -c * v : 0.0; };
}

std::vector<Law> laws_of_sensors() {
  return {{"sensor_lag", [](Extra& e, Random& r, const Sizes&) { e.average = between(r, 0.008, 0.030); }},
          {"sensor_scale", [](Extra& e, Random& r, const Sizes&) { e.scale = either_sign(r, 0.06, 0.15); }},
          {"sensor_offset",
           [](Extra& e, Random& r, const Sizes& s) { e.offset = either_sign(r, 0.02, 0.06) * s.stroke; }},
          {"sensor_drift",
           [](Extra& e, Random& r, const Sizes& s) { e.drift = either_sign(r, 0.002, 0.006) * s.stroke; }}};
}

std::vector<Law> laws_of_the_stage() {
  std::vector<Law> out{
      {"voltage_saturation",
       [](Extra& e, Random& r, const Sizes& s) { e.limit = between(r, 0.72, 0.88) * s.volts; }},
      {"amplifier_lag",
       [](Extra& e, Random& r, const Sizes&) { e.amplifier_time = between(r, 0.004, 0.015); }},
      {"charge_retention",
       [](Extra& e, Random& r, const Sizes&) {
         e.trapped = between(r, 0.06, 0.25), e.trapped_time = between(r, 1.5, 6.0);
       }},
      {"polarity_asymmetry",
       [](Extra& e, Random& r, const Sizes&) { e.one_sided = either_sign(r, 0.03, 0.1); }},
      {"film_hysteresis",
       [](Extra& e, Random& r, const Sizes& s) { e.film_loss = between(r, 0.02, 0.08) * s.volts; }},
      {"zipping_hysteresis",
       [](Extra& e, Random& r, const Sizes&) { e.play_height = between(r, 15e-6, 50e-6); }},
      {"residual_set", [](Extra& e, Random& r,
                          const Sizes&) { e.set = between(r, 0.05, 0.2), e.set_time = between(r, 8, 40); }},
      {"pouch_creep",
       [](Extra& e, Random& r, const Sizes&) {
         e.creep = between(r, 0.05, 0.25), e.creep_time = between(r, 2, 9);
       }},
      {"added_mass", add_mass},
      {"spring_hardening", [](Extra& e, Random& r, const Sizes&) { e.cubic = between(r, 1e8, 6e8); }},
      {"hysteretic_spring", add_sliders},
      {"quadratic_damping", [](Extra& e, Random& r, const Sizes&) { e.drag = between(r, 10.0, 60.0); }},
      {"external_force", add_push},
      {"periodic_disturbance", add_wave},
      {"end_stop", add_stop},
      {"coulomb_friction", add_friction},
      {"stribeck_friction", add_stiction},
      {"layer_puncture",
       [](Extra& e, Random& r, const Sizes& s) {
         e.surface = between(r, 0.3, 0.55) * s.stroke, e.rupture = between(r, 0.08, 0.25) * s.force;
         e.bulge = between(r, 0.06, 0.14) * s.stroke, e.after = between(r, 0.2, 0.4) * e.rupture;
       }},
      {"shaft_friction",
       [](Extra& e, Random& r, const Sizes& s) {
         e.grip_from = between(r, 0.1, 0.3) * s.stroke, e.grip = between(r, 0.06, 0.2) * s.force / s.stroke;
       }},
      {"tissue_relaxation",
       [](Extra& e, Random& r, const Sizes& s) {
         e.grip_from = between(r, 0.1, 0.3) * s.stroke, e.dragged = between(r, 0.08, 0.3) * s.spring;
         e.dragged_time = between(r, 0.8, 4.0);
       }},
      {"backlash", add_play}};
  for (const Law& one : laws_of_sensors()) out.push_back(one);
  out.push_back({"voltage_threshold", [](Extra& e, Random& r, const Sizes& s) {
                   e.threshold = between(r, 0.05, 0.15) * s.volts;
                 }});
  out.push_back({"directional_damping", add_valve});
  out.push_back(
      {"slow_unzipping", [](Extra& e, Random& r, const Sizes&) { e.slow_fall = between(r, 1.0, 3.0); }});
  return out;
}

std::vector<Law> laws_outside() {
  return {{"lopsided spring",
           [](Extra& e, Random& r, const Sizes& s) {
             const double k = between(r, 0.3, 0.7) * s.spring;
             e.law = [=](double x, double, double) { return -k * x * x / (std::abs(x) + 0.4 * s.stroke); };
           },
           "x"},
          {"drag of the power 1/2",
           [](Extra& e, Random& r, const Sizes& s) {
             const double c = between(r, 0.08, 0.2) * s.force;
             e.law = [=](double, double v, double) {
               return -c * v / std::sqrt(s.speed * std::max(std::abs(v), 0.01 * s.speed));
             };
           },
           "v"},
          {"thick grease at one end",
           [](Extra& e, Random& r, const Sizes& s) {
             const double c = between(r, 0.3, 0.8) * s.force / s.speed;
             e.law = [=](double x, double v, double) {
               return -c * v / (1.0 + std::exp(-8.0 * (x / s.stroke - 0.5)));
             };
           },
           "xv"},
          {"magnet below",
           [](Extra& e, Random& r, const Sizes& s) {
             const double f = between(r, 0.1, 0.2) * s.force, d = between(r, 1.3, 2.0) * s.stroke;
             e.law = [=](double x, double, double) { return -f * std::pow(d / std::max(d + x, 0.3 * d), 2); };
           },
           "x"},
          {"detents",
           [](Extra& e, Random& r, const Sizes& s) {
             const double f = between(r, 0.06, 0.15) * s.force, pitch = between(r, 0.4, 0.7) * s.stroke;
             e.law = [=](double x, double, double) { return -f * std::sin(6.283185307 * x / pitch); };
           },
           "x"}};
}

}  // namespace

const std::vector<Law>& stage_laws() {
  static const std::vector<Law> laws = laws_of_the_stage();
  return laws;
}

const std::vector<Law>& mass_laws() {
  static const std::vector<Law> laws{{"added_mass", add_mass},
                                     {"spring_hardening", add_cubic},
                                     {"hysteretic_spring", add_sliders},
                                     {"quadratic_damping", add_drag},
                                     {"external_force", add_push},
                                     {"periodic_disturbance", add_wave},
                                     {"end_stop", add_stop},
                                     {"coulomb_friction", add_friction},
                                     {"stribeck_friction", add_stiction},
                                     {"backlash", add_play},
                                     {"sensor_lag", laws_of_sensors()[0].add},
                                     {"directional_damping", add_valve}};
  return laws;
}

const std::vector<Law>& outside_stage_laws() {
  static const std::vector<Law> laws = [] {
    std::vector<Law> out = laws_outside();
    out.push_back({"guide gripped by the voltage",
                   [](Extra& e, Random& r, const Sizes& s) {
                     const double f = between(r, 0.08, 0.2) * s.force;
                     e.rub = [=](double, double u) { return f * std::pow(u / s.volts, 2); };
                   },
                   "u"});
    out.push_back({"plate pulled by the voltage",
                   [](Extra& e, Random& r, const Sizes& s) {
                     const double f = between(r, 0.05, 0.15) * s.force;
                     e.law = [=](double, double, double u) { return -f * std::pow(u / s.volts, 1.5); };
                   },
                   "u"});
    return out;
  }();
  return laws;
}

const std::vector<Law>& outside_mass_laws() {
  static const std::vector<Law> laws = [] {
    std::vector<Law> out = laws_outside();
    // On a stage it would be tissue that is dragged along.
    out.push_back({"spring whose end follows",
                   [](Extra& e, Random& r, const Sizes& s) {
                     e.memory_spring = between(r, 0.3, 0.8) * s.spring, e.memory_time = between(r, 0.1, 0.6);
                   },
                   "q"});
    out.push_back({"dry friction that grows along the way",
                   [](Extra& e, Random& r, const Sizes& s) {
                     const double f = between(r, 0.06, 0.15) * s.force;
                     e.rub = [=](double x, double) { return f * (1.0 + x / s.stroke); };
                   },
                   "xv"});
    out.push_back({"motor that saturates",
                   [](Extra& e, Random& r, const Sizes& s) {
                     const double f = between(r, 0.7, 1.0) * s.force;
                     e.law = [=](double, double, double u) { return f * std::tanh(u / f) - u; };
                   },
                   "u"});
    out.push_back({"motor weaker at one end",
                   [](Extra& e, Random& r, const Sizes& s) {
                     const double share = between(r, 0.15, 0.3);
                     e.law = [=](double x, double, double u) { return -share * u * x / s.stroke; };
                   },
                   "ux"});
    return out;
  }();
  return laws;
}

}  // namespace biopsy::blind
