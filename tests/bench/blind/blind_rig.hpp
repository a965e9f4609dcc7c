// Rigs of the blind challenge: the paper's stage and a mass on a spring, each with one thing more that a
// model of it may lack. Shares no code, parametrisation or range of numbers with sim/ or with tests/sim/gap:
// steps of Moreau and Jean's midpoint rule (dry friction as an impulse), spring-slider elements for
// hysteresis.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace biopsy::blind {

// SI. The paper's equations (docs/explanation/model.md, section 1).
struct StageRig {
  double gain = 0.74, leak_time = 11.0, permittivity = 3.1, film = 92e-6, width = 0.052, volume = 1.5e-7,
         rest_height = 0.31e-3, oil_time = 0.021, spring = 235.0, spring_loss = 0.09, slide_loss = 0.95,
         fixture = 0.041, plate_b = 0.026, capacity = 1.6e-9;
  int pouches = 13;
};

struct MassRig {
  double mass = 1.0, loss = 4.0, spring = 400.0;
};

// What is hidden; 0 is absent. SI. Forces act on plate A (the mass), positive up.
struct Extra {
  // electrical
  double limit = 0.0, amplifier_time = 0.0, trapped = 0.0, trapped_time = 3.0, one_sided = 0.0;
  // pouch
  double film_loss = 0.0, play_height = 0.0, set = 0.0, set_time = 25.0, creep = 0.0, creep_time = 6.0;
  // stage
  double mass = 0.0, cubic = 0.0, drag = 0.0, push = 0.0, friction = 0.0, static_friction = 0.0,
         static_speed = 2e-3, wave = 0.0, wave_hz = 0.37, stop = 0.0, stop_spring = 0.0, play = 0.0;
  double slider_spring = 0.0, slider_force = 0.0;  // four springs with sliders beside each other (Iwan)
  // tissue: surface, force and bulge at rupture, force after it
  double surface = 0.0, rupture = 0.0, bulge = 0.0, after = 0.0;
  double grip_from = 0.0, grip = 0.0, dragged = 0.0, dragged_time = 1.7;
  // sensor
  double average = 0.0, scale = 0.0, offset = 0.0, drift = 0.0;
  // not in the library: a force of position, speed, acting input; dry friction of position and input
  std::function<double(double x, double v, double u)> law;
  std::function<double(double x, double u)> rub;
  double memory_spring = 0.0, memory_time = 0.0;  // a spring whose far end follows within that time
  double slow_fall = 0.0;                         // the oil leaves a pouch more slowly by this share
  double threshold = 0.0;                         // V without any pull
};

struct Drive {
  double period = 1e-3, weight = 0.0;
  std::vector<double> input;  // V or N, held over each period
};

struct Seen {
  std::vector<double> displacement, plate_b;  // m, at the beginning of each period, without noise
};

Seen ride_stage(const StageRig& rig, const Extra& extra, const Drive& drive);
Seen ride_mass(const MassRig& rig, const Extra& extra, const Drive& drive);

// The voltage at which plate B of the rig stands `height` above its rest, V.
double voltage_for(const StageRig& rig, double height, double weight);

}  // namespace biopsy::blind
