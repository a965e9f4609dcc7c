#include "tests/sim/plant/reference_plant.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::sim {
namespace {

// The table of docs/explanation/model.md.
constexpr double kK = 0.80, kTau = 6.9, kEpsFilm = 3.4, kFilm = 100e-6, kL0 = 0.060, kV0 = 1.9e-7,
                 kH0 = 0.35e-3;
constexpr double kN = 11, kTauH = 0.030, kSpring = 140, kSpringDamping = 0.05, kSlider = 0.60;
constexpr double kFixture = 0.030, kPlateB = 0.030, kG = 9.81, kT = 1e-3;
constexpr double kEps0 = 8.8541878128e-12, kPi = 3.14159265358979323846;

double height_for(double u_o, double load) {
  const double P = kEpsFilm * kEps0 * u_o * u_o / (2 * kFilm * kFilm);
  if (P <= 0.0) return kH0;
  const long double S = static_cast<long double>(load) / (kL0 * P);
  const long double H = 2 / static_cast<long double>(kPi) * (std::sqrt(S * S + kPi * kV0 / kL0) - S);
  return std::max(kH0, static_cast<double>(H));
}

struct Body {
  double H = kH0, x = 0.0, v = 0.0;
};

struct Rate {
  double H, x, v, spring;
};

// Load -> height's rate -> plate B's speed -> spring -> load, until it no longer moves.
Rate rate_of(const Body& body, double u_o, double m_A, double push) {
  double dH = 0.0, spring = 0.0;
  for (int round = 0; round < 60; ++round) {
    const double v_B = kN * dH, x_B = kN * (body.H - kH0);
    spring = std::max(0.0, m_A * kG + kSpring * (x_B - body.x) + kSpringDamping * (v_B - body.v));
    const double next = (height_for(u_o, spring + kPlateB * kG) - body.H) / kTauH;
    const bool done = std::abs(next - dH) < 1e-13;
    dH = next;
    if (done) break;
  }
  return {dH, body.v, (spring - m_A * kG - kSlider * body.v - push) / m_A, spring};
}

}  // namespace

std::vector<ReferenceSample> reference_run(const std::vector<ReferenceInput>& inputs, double weight,
                                           double step) {
  const double m_A = kFixture + weight;
  const int steps = static_cast<int>(std::lround(kT / step));
  const double left = std::exp(-step / kTau);
  std::vector<ReferenceSample> out;
  Body body;
  double u_i = 0.0, u_o = 0.0, spring = m_A * kG;
  for (const ReferenceInput& input : inputs) {
    u_o += kK * (input.voltage - u_i);
    u_i = input.voltage;
    for (int i = 0; i < steps; ++i) {
      const Rate a = rate_of(body, u_o, m_A, input.external_force);
      const Body ahead{body.H + step * a.H, body.x + step * a.x, body.v + step * a.v};
      u_o *= left;
      const Rate b = rate_of(ahead, u_o, m_A, input.external_force);
      body.H += step / 2 * (a.H + b.H);
      body.x += step / 2 * (a.x + b.x);
      body.v += step / 2 * (a.v + b.v);
      spring = b.spring;
    }
    out.push_back({u_o, body.x, kN * (body.H - kH0), body.H, spring});
  }
  return out;
}

}  // namespace biopsy::sim
