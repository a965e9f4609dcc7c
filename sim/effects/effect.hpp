// What an effect declares. An effect is one physical term that can be absent; absent is exactly the baseline.
// Its file holds the parameters (SI inside, the units of files in `Parameter`), the equation, its state and
// its hooks. The plant calls, of each effect that is present and in the order of effect_list.hpp, the hooks
// that it has. `own` is the effect's state, passed where `State` is declared. SI units; x and v are plate
// A's.
//
//   volts    double limited(u)               voltage commanded of the amplifier for a requested one
//            AmplifierDynamics amplifier()   of the amplifier's output (one effect at most)
//            Screening screening()           of the stack's voltage (one effect at most)
//            double acting(u)                voltage that pulls, for what the screening leaves
//            double capacitance_ratio(deflection)   C1 + C2 over that of flat pouches (one effect at most)
//   pouch    double oil_time_ratio(gap)            of tau_h, for H_eq - H (m)
//            double pulling(u, own)                what is left of the voltage that pulls
//            Equilibrium held(goal, H_0, own)      where a pouch goes when pressure would carry it to `goal`
//            PouchOffset pouch_offset(pouch, own)  height on top of it, and a floor
//   plate A  double added_mass()             kg
//            double spring_push(spring, own) N, upward, besides the linear series spring
//            double load(plate, own)         N, downward, without dry friction
//            double dry_friction(plate)      N, its bound; v = 0 while it holds
//            bool rubs()                     whether it has any; without this hook it has
//            double friction_under(push)     N, the bound of what grows with the drive's push
//   sensor   double transmitted(own)         position of the sensor's target in place of plate A's
//            double target_motion(time)      added to that position
//            double filtered(own)            reading in place of the target's position
//            double read(reading, moment)    reading made of the reading so far
//   state    State = double: integrated with the motion, d own/dt = state_rate(flow, own); then bounded(own)
//            any other State: remember(moved, own), hold(H, H_0, own) and follow(from, to, h, own) at the end
//            of each substep; settle(steady, own) as steady motion leaves it; shift(dx, own) with the origin
//   numerics Steepness steepest(reach)       for the integrator's step
//            double cut_rate(outlook)        1/s by which a step is cut while something faster goes on
//   analysis constexpr bool acts_by_position the force depends on where plate A is: a weight put on it moves
//   the
//                                            stage into other conditions (sim/paper/closed_loop)
//            constexpr bool linearises       kept when the stage is linearised about a depth
//            (sim/paper/tuning)
//
// A hook of the right name and the wrong arguments does not compile.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace biopsy::sim {

enum class Attachment { Electrical, Pouch, Stage, Tissue, Sensor };

// What a number does in its effect: where a search for it begins.
enum class Role {
  Strength,   // all strengths 0: the effect is absent, exactly
  Shape,      // how it acts; the typical value is a start, within a factor of ten or so
  Place,      // where along the displacement it acts
  Level,      // above which voltage it acts
  Frequency,  // to be read off a spectrum
  Phase,
};

inline constexpr bool kMayBeLeftOut = true;

template <class Effect>
struct Parameter {
  std::string_view name;   // with its unit, as in files
  double Effect::*member;  // SI
  double si_per_unit;      // SI value of one file unit
  double low, high;        // sensible range, file units
  double typical;          // file units
  std::string_view meaning;
  Role role = Role::Strength;
  bool optional = false;  // may be left out of a file, and is then 0
};

struct EffectInfo {
  std::string_view name;
  Attachment attaches;
  std::string_view sentence;  // in plain words
  std::string_view equation;
  std::string_view experiment;  // that shows it most clearly
  std::string_view source;
};

// Output follows the command as a first-order lag whose slope is limited; both 0 is instantaneous.
struct AmplifierDynamics {
  double time = 0.0;  // s
  double slew = 0.0;  // s/V, the least time a volt takes

  bool instant() const { return time <= 0.0 && slew <= 0.0; }
};

// ds/dt = (share u_o - s)/time is subtracted from the stack's voltage u_o.
struct Screening {
  double share, time;  // -, s
};

// Height of a pouch under its load, and how that changes with the load.
struct Equilibrium {
  double H = 0.0;      // m
  double slope = 0.0;  // m/N, dH/dF
};

struct PouchMotion {
  double deflection;  // m, H - H_0
  double H_0;         // m
  double since;       // s since `own` was remembered
};

struct PouchOffset {
  double height = 0.0;  // m, added to H
  double rate = 0.0;    // m/s, of the height at constant H
  double per_H = 0.0;   // growth of the height per growth of H
  double floor = 0.0;   // m, least H
};

struct SpringMotion {
  double stretch;  // m, x_B - x_A; -x_A where a force drives and the spring stands on the frame
  bool on_stack;   // the drive is a stack
};

struct PlateMotion {
  double x, v;    // m, m/s
  double x_max;   // m, deepest so far
  double time;    // s since the run began
  bool on_stack;  // the drive is a stack
};

// What drives an integrated state.
struct Flow {
  double deflection;  // m, H - H_0
  double x, v;        // m, m/s; v = 0 while dry friction holds plate A
  double n, dH;       // number of pouches; m/s of each: plate B moves with n dH, and 0 where a force drives
};

// At the end of a substep of h.
struct Moved {
  double deflection, x, h;  // m, m, s
};

// Plate A moves steadily; the pouches were changed by dH to get there.
struct SteadyMotion {
  double dH, deflection, H_0;  // m
  double x, v;                 // m, m/s
  double target;               // m, position of the sensor's target
};

struct ReadingMoment {
  double time;                  // s since the run began
  std::uint64_t seed, reading;  // of the noise
};

struct Reach {
  double x, v;  // m, m/s that plate A stays within
};

struct Steepness {
  double stiffness = 0.0, damping = 0.0;  // N/m, N s/m on plate A
  double rate = 0.0;                      // 1/s of what moves by itself
};

// What a step of h starts from.
struct Outlook {
  double u_command, u_i;  // V
  double x, v;            // m, m/s
  double mass;            // kg, of plate A
  double h;               // s
};

}  // namespace biopsy::sim
