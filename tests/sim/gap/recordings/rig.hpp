// Recordings of a mass on a spring, made without sim/: its own parameters (natural frequency and damping
// ratio), velocity Verlet in short steps, and a dry contact of Jenkins' kind (a stiff spring that slides).
#pragma once

#include <cstdint>

#include "sim/plant/dataset.hpp"

namespace biopsy::hidden {

struct Rig {
  double mass = 0.4, hertz = 2.5, damping_ratio = 0.15;  // kg, Hz, -
  double grip = 0.0;                                     // N at which the contact slides
  double one_way = 0.0;                                  // N by which that is more upward, less downward
  double side_load = 0.0;                                // of the push, that adds to it
  double stiffening = 0.0;                               // 1/m^2, of the spring's stiffness with x^2
  double softens = 0.0, softens_in = 3.0;                // of its stiffness, lost in a run; s
  double lopsided = 0.0;                                 // 1/m, of the spring's stiffness with x
  double second = 0.0, second_at = 3e-3;  // of its stiffness, more beyond a place either way, m
  double valve = 0.0;                     // of the damping, more while it moves downward
  double dent = 0.0, dent_at = 0.0;       // N, of a push around a place, m
  double rough = 0.0, rough_at = 0.0;     // N s/m of damping around a place, m
};

// Four runs of 8 s at 250 Hz, of a multisine and of steps. Readings in m with white noise [m].
sim::Dataset rig_recording(const Rig& rig, double noise, std::uint64_t seed);

// The same recording with the displacement that its inputs cause now.
sim::Dataset ridden_again(const Rig& rig, sim::Dataset recording, double noise);

// The model of a rig without grip and stiffening, as a file.
std::string rig_model(const Rig& rig);

}  // namespace biopsy::hidden
