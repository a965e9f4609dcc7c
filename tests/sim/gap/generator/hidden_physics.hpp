// The hidden truth of a test: numbers of the baseline (docs/explanation/model.md, section 1) and of what is
// added to it. SI. Written apart from sim/ on purpose: other parametrisations, so that agreement with sim/
// means something.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace biopsy::hidden {

struct StageNumbers {
  double K = 0.80, tau = 6.9, eps_film = 3.4, d_film = 100e-6, L0 = 0.060, V0 = 1.9e-7, H_0 = 0.35e-3, n = 11;
  double tau_h = 0.030, k = 140, c_k = 0.05, c_s = 0.60, fixture = 0.030, m_B = 0.030, C1 = 2.0e-9, g = 9.81;
};

struct MechanismNumbers {  // drive = "force"; a shaker with a natural frequency of 4.5 Hz
  double m = 0.5, c_s = 3.0, k = 400.0;
};

// Zero in the first number of a line: that effect is absent.
struct HiddenPhysics {
  // electrical
  double trap_capture = 0, trap_release = 0.4;      // 1/s: charge caught from u_o, charge let go
  double amplifier_time = 0, amplifier_slew = 8e5;  // s, V/s
  double saturation = 0, saturation_power = 24;     // V; soft knee u/(1+|u/L|^p)^(1/p)
  double asymmetry = 0;                             // relative pressure of positive over negative
  double dead_band = 0;                             // V that do not pull; a soft onset, 30 V wide
  double film_growth = 0;  // 1/m of pouch height: growth of C2 over C2 of flat pouches
  double weak_field = 0;   // pressure falls by |u|/1 kV to this power
  // pouch
  double zip_radius = 0;                // m of one pouch; two plays, radius r and 2 r
  double set_share = 0, set_time = 25;  // of the peak, s
  double creep_share = 0;               // of the height, three decades of time
  double slow_fall = 0;                 // relative growth of tau_h while the stack falls
  // stage
  double friction = 0, breakaway_ratio = 1;      // N
  double bristles = 1e-6;                        // m, bend before they slip
  double side_load = 0;                          // friction over the push of spring or drive
  double stribeck_speed = 3e-3;                  // m/s
  double drag = 0;                               // N s2/m2
  double cubic = 0;                              // N/m3 of deflection
  double spring_asymmetry = 0;                   // 1/m: stiffness k (1 + a delta)
  double second_spring = 0, second_at = 0.4e-3;  // of k, reached after so much deflection (m) either way
  double valve = 0;                              // N s/m, while plate A falls
  double bouc_force = 0, bouc_length = 0.8e-3;   // N, m; Bouc-Wen in (A, beta, gamma)
  double rope = 0, rope_length = 2e-3;           // N/m, m; Bouc-Wen that hardens, on plate A
  double play = 0;                               // m, half of the free play
  double stop_at = 0, stop_stiffness = 2e6;      // m, N/m^1.5 (Hertz)
  double extra_mass = 0, push = 0;               // kg, N (down)
  double wave_force = 0, wave_hz = 0.3, wave_phase = 1;  // N, Hz, rad
  bool wave_phase_by_run = false;                        // random phase for each run
  // tissue
  double puncture_force = 0, puncture_at = 1e-3, puncture_bulge = 0.5e-3;  // N, m, m
  double shaft_friction = 0, shaft_viscous = 0;                            // N/m, N s/m2
  double relax_stiffness = 0, relax_time = 2;                              // N/m, s
  // sensor
  double delay = 0, offset = 0, gain_error = 0, drift = 0;  // s, m, -, m/s
  // outside the library
  double heating = 0;       // relative loss of permittivity at full heat, heat from switching, 12 s
  double bump_damping = 0;  // N s/m, around 1.6 mm
  double shock_force = 0;   // N, 6 ms, at random times
  double zip_ledge = 0;     // m of pouch height: films zip in ledges
  double speckle = 0;       // m: reading wanders with a memory of 0.7 s
  double cyclic_error = 0;  // m: error of the reading, period 0.9 mm of travel
  double clock_jitter = 0;  // s
  double breakdown = 0;     // share of u_o lost in a discharge, at random times above 1.3 kV
  double thickening = 0;    // 1/s: tau_h grows with time
  // N, up, on plate A of a stage, of position, speed and the stack's voltage
  std::function<double(double x, double v, double u)> law;
};

// Seeded draws that are the same on every machine (std::normal_distribution is not).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_(seed * 0x9E3779B97F4A7C15ULL + 0x1234567) {}
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1.0p-53; }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  double normal();

 private:
  std::mt19937_64 bits_;
};

// What a run does to the machine: input[i] is held from row i to row i + 1.
struct Program {
  double period = 1e-3, weight = 0.0;  // s, kg
  std::vector<double> input, push;     // V or N; N down
};

struct Trace {
  std::vector<double> displacement, plate_b, current;  // per row, before sensor noise
};

inline constexpr double kSubstep = 50e-6;

// Leapfrog with exact bristles, at most `substep` long. `seed` draws what is random about the physics of this
// run.
Trace run_stage(const StageNumbers& numbers, const HiddenPhysics& physics, const Program& program,
                std::uint64_t seed, double substep = kSubstep);
Trace run_mechanism(const MechanismNumbers& numbers, const HiddenPhysics& physics, const Program& program,
                    std::uint64_t seed, double substep = kSubstep);

}  // namespace biopsy::hidden
