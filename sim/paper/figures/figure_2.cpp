// Fig. 2: the leakage circuit under DC and under a square wave; closed forms (6) and (14) to (17) against the
// plant's own circuit.
#include <algorithm>
#include <cmath>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/open_loop.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kExact = 1e-6;             // share of the amplitude; binding for this figure
constexpr double kAmplitude = 1.0;          // V, paper II.B
constexpr double kFrequency = 0.1;          // Hz: with visible leakage within half a period
constexpr double kPeriod = 10e-3;           // s between samples
constexpr double kHalf = 0.5 / kFrequency;  // s, `a` of eq. (11)

struct Voltages {
  std::vector<double> time, u_i, u_o;
};

// The paper's circuit has no effects.
PlantModel circuit_alone(const PlantModel& stage) {
  PlantModel model = stage;
  model.effects = {};
  return model;
}

Voltages simulated(const PlantModel& model, double frequency, double seconds) {
  Voltages out;
  PlantState state = at_rest(model);
  const auto rows = static_cast<int>(std::lround(seconds / kPeriod));
  for (int i = 0; i < rows; ++i) {
    const double volts = kAmplitude * polarity_at(i * kPeriod, frequency);
    state = step(model, state, {.voltage = volts}, Seconds(kPeriod));
    out.time.push_back((i + 1) * kPeriod);
    out.u_i.push_back(volts);
    out.u_o.push_back(state.u_o);
  }
  return out;
}

// eq. (6)
double direct(const Baseline& b, double t) {
  return b.K * std::exp(-t / b.tau);
}

// A sample is taken just before the voltage of its instant is applied: at t = n a it belongs to n - 1.
int half_periods(double t) {
  return static_cast<int>(std::ceil(t / kHalf - 1e-6)) - 1;
}

// eq. (14)
double alternating(const Baseline& b, double t) {
  const double P = -1.0 / b.tau;
  const int n = half_periods(t);
  const double sign = n % 2 == 0 ? 1.0 : -1.0;
  const double sum = -2.0 * b.K * std::exp(P * t) + 2.0 * b.K * sign * std::exp(P * (t - n * kHalf));
  return b.K * std::exp(P * t) + sum / (1.0 + std::exp(P * kHalf));
}

// eq. (15)
double periodic(const Baseline& b, double t) {
  const double P = -1.0 / b.tau;
  const int n = half_periods(t);
  const double sign = n % 2 == 0 ? 1.0 : -1.0;
  return sign * 2.0 * b.K * std::exp(P * (t - n * kHalf)) / (1.0 + std::exp(P * kHalf));
}

template <class Form>
double largest_error(const Baseline& b, const Voltages& volts, double from, Form&& form) {
  double worst = 0.0;
  for (std::size_t i = 0; i < volts.time.size(); ++i)
    if (volts.time[i] > from)
      worst = std::max(worst, std::abs(volts.u_o[i] - form(b, volts.time[i])) / kAmplitude);
  return worst;
}

// Largest and smallest |u_o| of the last half period; the largest is at its beginning.
struct Limits {
  double upper, lower;
};
Limits last_limits(const Baseline& b, const Voltages& volts) {
  const auto half = static_cast<std::size_t>(std::lround(kHalf / kPeriod));
  const double first = std::abs(volts.u_o[volts.u_o.size() - half]), last = std::abs(volts.u_o.back());
  return {first * std::exp(kPeriod / b.tau), last};
}

FigurePanel panel(std::string title, const Voltages& volts, double seconds) {
  FigurePanel out{std::move(title), "time (s)", "voltage (V)", 0.0, seconds, -1.5, 1.5, false, {}};
  FigureCurve in{"u_i", {}, {}, true, false}, stack{"u_o", {}, {}, false, false};
  for (std::size_t i = 0; i < volts.time.size() && volts.time[i] <= seconds; ++i) {
    in.x.push_back(volts.time[i]);
    in.y.push_back(volts.u_i[i]);
    stack.x.push_back(volts.time[i]);
    stack.y.push_back(volts.u_o[i]);
  }
  out.curves = {in, stack};
  return out;
}

PaperRow exact_row(std::string equation, double error) {
  return at_most_row({"2", std::move(equation), "of u_i"}, kExact, error, "largest difference at any sample");
}

}  // namespace

PaperFigure figure_2(const PaperModel& paper) {
  const PlantModel model = circuit_alone(paper.stage);
  const Baseline& b = model.baseline;
  const double settled = std::ceil(20.0 * b.tau / kHalf) * kHalf;  // exp(-20) is beyond 1e-6
  const Voltages dc = simulated(model, 0.0, 10.0 * kHalf);
  const Voltages ac = simulated(model, kFrequency, settled + 2.0 * kHalf);
  const double left = std::exp(-kHalf / b.tau);
  const Limits limits = last_limits(b, ac);
  PaperFigure out{"2",
                  "Leakage: the stack's voltage under a constant voltage and under a square wave of 0.1 Hz",
                  "Under DC the voltage on the stack leaks away; reversals bring it back, twice a period.",
                  {},
                  {}};
  out.panels = {panel("DC", dc, 50.0), panel("square wave", ac, 50.0)};
  out.rows = {
      exact_row("eq. (6): DC, closed form against simulation", largest_error(b, dc, 0.0, direct)),
      exact_row("eq. (14): square wave from rest, closed form against simulation",
                largest_error(b, ac, 0.0, alternating)),
      exact_row("eq. (15): square wave in the end, closed form against simulation",
                largest_error(b, ac, settled, periodic)),
      exact_row("eq. (16): upper limit K1 against simulation",
                std::abs(limits.upper - 2.0 * b.K / (1.0 + left)) / kAmplitude),
      exact_row("eq. (17): lower limit K2 against simulation",
                std::abs(limits.lower - 2.0 * b.K * left / (1.0 + left)) / kAmplitude),
  };
  return out;
}

}  // namespace biopsy::sim::paper
