// Fig. 4: geometry and materials of a pouch (III.A) beside the numbers of the model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/paper/figures/figures.hpp"
#include "sim/paper/figures/rows.hpp"
#include "sim/paper/stack_height.hpp"
#include "sim/plant/pouch.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kOil = 3.2e-6;            // m^3 in a pouch of two chambers, III.A
constexpr double kChamber = 28.5e-3;       // m, half of 60 mm less a seam of 3 mm
constexpr double kOilPermittivity = 2.7;   // of a silicone oil; the paper does not name its oil
constexpr double kFilmResistivity = 1e15;  // Ohm m, polyimide film (DuPont Kapton HN, data sheet)
constexpr double kLoad = 0.060;            // kg, Fig. 8b

// The pouch by its printed oil alone: eq. (18) for one chamber, at rest as high as its oil.
Baseline by_printed_oil(Baseline b) {
  b.V0 = 0.5 * kOil;
  b.H_0 = kPouchAtRest - b.d_film;
  return b;
}

// Stroke of the stack by eq. (18) to (21). mm
double stroke(const Baseline& b, double volts) {
  return 1e3 * b.n * (equilibrium(b, pressure(b, b.K * volts), kLoad * b.g).H - b.H_0);
}

FigurePanel strokes(const Baseline& b) {
  FigurePanel panel{"eq. (18) to (21), 60 g", "voltage (kV)", "stroke (mm)", 0.0, 8.0, 0.0, 1.0, false, {}};
  panel.curves = {{"the model's displaced volume", {}, {}, false, false},
                  {"the printed 3.2 mL of oil", {}, {}, true, false}};
  for (int i = 0; i <= 160; ++i) {
    const double volts = 50.0 * i;
    const double ours = stroke(b, volts), printed = stroke(by_printed_oil(b), volts);
    for (FigureCurve& curve : panel.curves) curve.x.push_back(1e-3 * volts);
    panel.curves[0].y.push_back(ours);
    panel.curves[1].y.push_back(printed);
    panel.y_high = std::max({panel.y_high, 1.05 * ours, 1.05 * printed});
  }
  return panel;
}

// Of all pouches in parallel, with `gap` of oil between the films. F
double capacitance(const Baseline& b, double gap) {
  const double area = 2.0 * kChamber * b.L0 * b.n;
  return kVacuumPermittivity * area / (b.d_film / b.eps_film + gap / kOilPermittivity);
}

}  // namespace

PaperFigure figure_4(const PaperModel& model) {
  const Baseline& b = model.stage.baseline;
  const double C2 = b.C1 * (1.0 - b.K) / b.K, R = b.tau / (b.C1 + C2);
  const double oil_height = kOil / (2.0 * kChamber * b.L0);
  const double flat = b.V0 / (b.L0 * b.H_0) - 0.25 * std::numbers::pi * b.H_0;
  const double highest = 1e3 * b.n * (std::sqrt(4.0 * b.V0 / (std::numbers::pi * b.L0)) - b.H_0);
  PaperFigure out{
      "4",
      "Geometry and materials of the pouches, III.A",
      "What is printed of a pouch beside what the model needs of it. Permittivity, thickness of the films, "
      "width, number of pouches and mass of the plates are the paper's and stay.",
      {},
      {}};
  out.panels = {strokes(b)};
  out.rows = {
      number_row({"4", std::string(kOilQuantity), "mL"}, 1e6 * kOil, 1e6 * b.V0,
                 fmt::format("by eq. (18) V0 is the oil of a pouch. With 3.2 mL in two chambers eq. (18) to "
                             "(21) give a stroke "
                             "of {:.0f} mm at 8 kV with 60 g, where Fig. 8b has 8 mm: fitted, V0 is the "
                             "share of the oil that "
                             "moves",
                             stroke(by_printed_oil(b), 8000.0))),
      shown_row({"4", "stack at rest by its oil and films, and by the model's H_0", "mm"},
                1e3 * stack_height(b.n), 1e3 * b.n * (b.H_0 + b.d_film),
                fmt::format(
                    "strain is referred to the first: 11 pouches whose oil is {:.2f} mm high on average. H_0 "
                    "is where eq. (18) begins to lift, not the height of the oil",
                    1e3 * oil_height)),
      shown_row({"4", "length of a chamber, and of the model's oil lying flat", "mm"}, 1e3 * kChamber,
                1e3 * flat,
                flat <= kChamber ? "it fits"
                                 : "it does not fit: H_0 and V0 do not belong to one pouch of this size"),
      shown_row({"4", "stroke of Fig. 12, and the largest that V0 allows", "mm"}, 8.0, highest,
                "eq. (18) with a contact length of 0"),
      shown_row(
          {"4", "C2 by the films with the oil between them, and by K and C1", "nF"},
          1e9 * capacitance(b, oil_height), 1e9 * C2,
          fmt::format(
              "all electrodes zipped: {:.1f} nF. K and C1 agree with the geometry where C2 lies between; "
              "electrodes as large as the chambers",
              1e9 * capacitance(b, 0.0))),
      shown_row(
          {"4", "resistivity of polyimide, and of the films by tau", "Ohm m"}, kFilmResistivity,
          R * 2.0 * kChamber * b.L0 * b.n / b.d_film,
          "a film of its data sheet would hold its charge for hours: what leaks in Fig. 6 is not the bulk of "
          "the film"),
      shown_row({"4", "field in the films at 8 kV: the whole voltage, and the model's share K", "V/um"},
                8e-3 / b.d_film, 8e-3 * b.K / b.d_film, "50 um films, two of them zipped")};
  return out;
}

}  // namespace biopsy::sim::paper
