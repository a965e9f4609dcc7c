// Compiled for several instruction sets; which one runs is chosen at start. No multiplication is fused with
// an addition in any, so that all give the same bits.
#include "sim/plant/lanes.hpp"

#include <cmath>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define BIOPSY_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define BIOPSY_CLONES
#endif

namespace biopsy::sim {
namespace {

struct Point3 {
  double H, x, v;
};
struct Rate3 {
  double dH, dv, net;  // net: N, before friction
};

// As spring_force() and net_force() of mechanics.cpp, operation by operation.
[[gnu::always_inline]] inline Rate3 rate(const LaneConstants& c, std::size_t i, const Point3& m, double u,
                                         double external_force, double friction) {
  const double stretch = c.n[i] * (m.H - c.H_0[i]) - m.x;
  const double undamped = c.mass_g[i] + c.k[i] * stretch - c.c_k[i] * m.v;
  const double pressure = c.permittivity[i] * u * u / c.film[i];
  const double load = (0.0 < undamped ? undamped : 0.0) + c.load_B[i];
  const double stiffness = c.L0[i] * pressure;
  const double root = std::sqrt(load * load + c.a[i] * stiffness * stiffness);
  const double carried = c.a_H[i] * stiffness / (root + load);
  const bool lifts = carried > c.H_0[i];  // false where nothing pulls and nothing loads: 0/0
  const double goal = lifts ? carried : c.H_0[i];
  const double slope = lifts && undamped > 0.0 ? -carried / root : 0.0;
  const double dH = (goal - m.H) / (c.tau_h[i] - slope * c.c_k[i] * c.n[i]);
  const double damped = undamped + c.c_k_n[i] * dH;
  const double spring = 0.0 < damped ? damped : 0.0;
  const double net = spring - c.mass_g[i] - (c.c_s[i] * m.v + external_force);
  return {dH, (net - friction) / c.mass[i], net};
}

}  // namespace

BIOPSY_CLONES void advance_lanes(const LaneConstants& c, const LaneStates& before, const LaneInputs& inputs,
                                 double h, LaneStates& after, PerLane& event) {
#ifdef __GNUC__
#pragma GCC ivdep  // `after` and `event` are none of the others
#endif
  for (std::size_t i = 0; i < kLanes; ++i) {
    const double jump = inputs.voltage[i] - before.u_i[i];
    const double u_start = before.u_o[i] + c.K[i] * jump;
    const double u_half = u_start * c.half_decay[i], u_end = u_half * c.half_decay[i];
    const double push = inputs.external_force[i], bound = c.friction[i];
    const bool dry = c.dry[i] > 0.0;
    const double moves = before.v[i] > 0.0 ? 1.0 : before.v[i] < 0.0 ? -1.0 : dry ? 0.0 : 1.0;
    const double direction = dry ? moves : 1.0;
    const bool stuck = direction == 0.0;
    const double friction = dry ? direction * bound : 0.0;
    const Point3 m{before.H[i], before.x[i], before.v[i]};
    const Rate3 r = rate(c, i, m, u_start, push, friction);
    const double r_dv = stuck ? 0.0 : r.dv;
    const Point3 p{m.H + h * (0.5 * r.dH), m.x + h * (0.5 * m.v), m.v + h * (0.5 * r_dv)};
    const Rate3 s = rate(c, i, p, u_half, push, friction);
    const double s_dv = stuck ? 0.0 : s.dv;
    const Point3 q{m.H + h * (-1.0 * r.dH + 2.0 * s.dH), m.x + h * (-1.0 * m.v + 2.0 * p.v),
                   m.v + h * (-1.0 * r_dv + 2.0 * s_dv)};
    const Rate3 t = rate(c, i, q, u_end, push, friction);
    const double t_dv = stuck ? 0.0 : t.dv;
    constexpr double kOuter = 1.0 / 6, kInner = 4.0 / 6;
    const Point3 end{m.H + h * (kOuter * r.dH + kInner * s.dH + kOuter * t.dH),
                     m.x + h * (kOuter * m.v + kInner * p.v + kOuter * q.v),
                     m.v + h * (kOuter * r_dv + kInner * s_dv + kOuter * t_dv)};
    const Rate3 held = rate(c, i, end, u_end, push, 0.0);
    const bool lets_go = std::abs(r.net) > bound || bound - std::abs(held.net) < 0.0;
    const bool stops = end.v * direction <= 0.0;
    event[i] = dry && (stuck ? lets_go : stops) ? 1.0 : 0.0;
    after.H[i] = end.H;
    after.x[i] = end.x;
    after.v[i] = end.v;
    after.u_i[i] = inputs.voltage[i];
    after.u_o[i] = u_end;
    after.charge[i] = c.C1[i] * (1.0 - c.K[i]) * jump + c.C1[i] * (0.0 - (u_end - u_start));
    after.time[i] = before.time[i] + h;
    after.x_max[i] = before.x_max[i] < end.x ? end.x : before.x_max[i];
  }
}

}  // namespace biopsy::sim
