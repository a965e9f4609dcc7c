// A figure of the paper as our model draws it, with the paper's numbers beside ours. Values only: sim/paper
// makes it, robot/report prints it. Units are people's (mm, s, kV, Hz, per cent), named in the titles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace biopsy {

// A line in a panel; x never falls where it is a time, and may turn back where it is a voltage (hysteresis).
struct FigureCurve {
  std::string name;  // in the legend; empty: none
  std::vector<double> x, y;
  bool dashed = false;  // targets, and what is only there to compare with
  bool marks = false;   // measured points rather than a course
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
  Shown,   // nothing in the paper to compare with: what lies beyond it. Counts in no score
};

// One number or statement of the paper against ours. Shown rows leave paper and ours as they are told.
struct PaperRow {
  std::string figure;    // "6", "7a", "beyond"
  std::string quantity;  // for a person, complete in itself
  std::string unit;      // "mm", "%", "1" for trends and ratios
  RowKind kind = RowKind::Number;
  double paper = 0.0, ours = 0.0;
  double band = 0.2;  // share of the paper's number that ours may be off; 0 unless kind is Number
  bool ok = false;
  double margin = 0.0;  // of a Trend: how far from turning, as a share; positive where it holds
  std::string note;     // why it is missed, or how it was read; never empty where ok is false
};

struct PaperFigure {
  std::string number;    // as in the paper: "2", "6", "7a"; "beyond" for what goes beyond it
  std::string title;     // what was done
  std::string sentence;  // what there is to see, whatever the model
  std::vector<FigurePanel> panels;
  std::vector<PaperRow> rows;
};

struct Reproduction {
  std::string model;  // which was asked, for the page
  std::vector<PaperFigure> figures;
  std::vector<std::string> left_out;  // numbers of figures that an interruption left out
  double seconds = 0.0;  // it took
};

}  // namespace biopsy
