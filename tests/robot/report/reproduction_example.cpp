#include "tests/robot/report/reproduction_example.hpp"

#include <cmath>
#include <numbers>

namespace biopsy::report {
namespace {

FigureCurve course(const std::string& name, double rate, double swing) {
  FigureCurve curve;
  curve.name = name;
  for (int i = 0; i <= 8000; ++i) {
    const double t = i * 1e-3;
    curve.x.push_back(t);
    curve.y.push_back(3.0 * (1.0 - std::exp(-rate * t)) + swing * std::sin(2.0 * std::numbers::pi * 4.0 * t));
  }
  return curve;
}

PaperRow row(const std::string& quantity, RowKind kind, double paper, double ours, bool ok,
             const std::string& note) {
  PaperRow out;
  out.figure = "7a";
  out.quantity = quantity;
  out.unit = kind == RowKind::Trend ? "1" : "mm";
  out.kind = kind;
  out.paper = paper;
  out.ours = ours;
  out.band = kind == RowKind::Number ? 0.2 : 0.0;
  out.ok = ok;
  out.note = note;
  return out;
}

}  // namespace

FigurePanel example_loop() {
  FigurePanel panel{"Strain at 60 g", "amplitude (kV)", "strain (%)", 0.0, 8.0, 0.0, 60.0, false, {}};
  FigureCurve loop;
  loop.name = "60 g";
  for (int i = 0; i <= 400; ++i) {
    const double along = i / 400.0, volts = 8.0 * (along < 0.5 ? 2.0 * along : 2.0 - 2.0 * along);
    loop.x.push_back(volts);
    loop.y.push_back(50.0 / (1.0 + std::exp(-(volts - (along < 0.5 ? 4.5 : 3.0)))));
  }
  panel.curves = {loop};
  return panel;
}

Reproduction example_reproduction() {
  PaperFigure a{
      "7a", "square waves of four frequencies", "The level rises from 0.2 to 2 Hz & stays there.", {}, {}};
  a.panels.push_back({"6 kV, 20 g",
                      "time (s)",
                      "displacement (mm)",
                      0.0,
                      8.0,
                      0.0,
                      4.0,
                      false,
                      {course("2 Hz", 3.0, 0.3), course("0.2 Hz", 1.0, 0.1)}});
  FigureCurve dots{"80 g", {0.1, 0.2, 0.5, 1, 2, 5, 10}, {2, 1.6, 1.1, 0.7, 0.6, 0.55, 0.5}, false, true};
  FigureCurve target{"asked for", {0.1, 10}, {1, 1}, true, false};
  a.panels.push_back({"Swing against frequency",
                      "frequency (Hz)",
                      "peak to peak (mm)",
                      0.1,
                      10.0,
                      0.0,
                      2.2,
                      true,
                      {dots, target}});
  a.rows = {
      row("RMSE over settled windows", RowKind::Number, 0.077, 0.0801, true, "settled: 3 s after an edge"),
      row("drop of <50 um> PI in 10 s", RowKind::Number, 71.0, 40.0, false,
          "the film creeps & the model does not"),
      row("overshoot", RowKind::AtMost, 10.0, 7.5, true, ""),
      row("time to recover", RowKind::AtMost, 4.0, 5.0, false, "spring too soft"),
      row("level rises from 0.2 to 2 Hz", RowKind::Trend, 1.0, 1.0, true, ""),
      row("largest at 80 g", RowKind::Trend, 1.0, 0.0, false, "no resonance in the model")};
  PaperFigure b{"8b", "hysteresis", "Less with more load.", {example_loop()}, {}};
  b.rows = {row("largest strain", RowKind::Number, 50.0, 52.0, true, "")};
  b.rows.front().figure = "8b";
  b.rows.front().unit = "%";
  PaperFigure beyond{"beyond", "sine with feed-forward", "Beside PI.", {}, {}};
  beyond.rows = {row("RMSE of the sine", RowKind::Shown, 0.211, 0.0912, true, "costs 0.4 kV")};
  beyond.rows.front().figure = "beyond";
  return {"sim/models/my stage.toml", {a, b, beyond}, {}, 12.34};
}

}  // namespace biopsy::report
