// A figure of the paper reproduced by the model, with the paper's numbers beside the model's. Values only;
// made by sim/paper, printed by robot/report. Units (mm, s, kV, Hz, %) are named in the titles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace biopsy {

// A line in a panel; x never falls where it is a time, and may turn back where it is a voltage (hysteresis).
struct FigureCurve {
  std::string name;  // in the legend; empty: none
  std::vector<double> x, y;
  bool dashed = false;    // targets and references
  bool marks = false;     // points instead of a line,
  bool numbered = false;  // from 1, as the rows of the table beside them
};

struct FigurePanel {
  std::string title, x_title, y_title;  // with units
  double x_low = 0.0, x_high = 1.0, y_low = 0.0, y_high = 1.0;
  bool logarithmic_x = false;
  std::vector<FigureCurve> curves;
};

enum class RowKind : std::uint8_t {
  Number,  // |ours / paper - 1| <= band
  AtMost,  // ours <= paper
  Trend,   // a statement of the paper: paper is 1, ours is 1 where it holds and 0 where it does not
  Shown,   // without a number in the paper to compare with; not scored
};

// A row by a calibration that left its figure out.
struct HeldOutValue {
  double ours = 0.0;
  bool ok = false;
};

// One number or statement of the paper beside the model's. In Shown rows `paper` is a reference value.
struct PaperRow {
  std::string figure;    // "6", "7a", "beyond"
  std::string quantity;  // understandable without context
  std::string unit;      // "mm", "%", "1" for trends and ratios
  RowKind kind = RowKind::Number;
  double paper = 0.0, ours = 0.0;
  double band = 0.2;  // tolerance, as a share of the paper's number; 0 unless kind is Number
  bool ok = false;
  double margin = 0.0;  // of a Trend: relative distance from its limit; positive where it holds
  std::string note;     // how it was evaluated, or why it is missed; never empty where ok is false
  std::optional<bool> leakage_ok{};        // met by the leakage model without effects; none: not compared
  std::optional<HeldOutValue> held_out{};  // none: not measured for this model
};

// What a model was fitted to.
struct FittedTo {
  std::size_t unknowns = 0, numbers = 0, statements = 0;
  std::string command;  // that left one figure out at a time
};

struct PaperFigure {
  std::string number;    // as in the paper: "2", "6", "7a"; "beyond" for what goes beyond it
  std::string title;     // what was done
  std::string sentence;  // what the figure shows, for any model
  std::vector<FigurePanel> panels;
  std::vector<PaperRow> rows;
};

struct Reproduction {
  std::string model;  // its name
  std::vector<PaperFigure> figures;
  std::vector<std::string> left_out;  // numbers of figures that an interruption left out
  double seconds = 0.0;               // wall time
  std::optional<FittedTo> fitted{};   // none: not known of this model
};

}  // namespace biopsy
