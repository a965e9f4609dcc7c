// Pareto-optimal designs of the stack, and the paper's own beside them. Values only; made by
// sim/paper/design, printed by robot/report. Units are in the names.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/paper/paper_figure.hpp"

namespace biopsy {

// Design variables.
struct StackDesign {
  double oil_mL = 3.2;            // filled into one pouch
  double side_mm = 60.0;          // of the square pouch and its electrodes
  double film_um = 50.0;          // one film; a zipped pouch has two
  double pouches = 11.0;          // stacked, a whole number
  double spring_N_per_mm = 0.14;  // in series
  double drive_kV = 6.0;          // amplitude of the square wave
};

// Figures of merit.
struct StackFigures {
  double stroke_mm = 0.0;         // of the needle against the tissue's push
  double ripple_mm = 0.0;         // peak to peak of the needle at the drive's frequency
  double bandwidth_Hz = 0.0;      // up to which the needle follows small changes of amplitude
  double field_V_per_um = 0.0;    // highest in the films
  double breakdown_margin = 0.0;  // the film's guaranteed strength over that field
  double height_mm = 0.0;         // of the stack at rest
};

struct DesignedStack {
  StackDesign design;
  StackFigures figures;
  std::vector<std::string> broken;  // requirements that are not met, as text; empty: meets all
  double shortfall = 0.0;           // sum of the relative shortfalls; 0 where all are met
};

struct DesignStudy {
  std::string model;  // the stage all designs are scaled from
  DesignedStack paper;
  std::vector<DesignedStack> best;   // Pareto-optimal; by rising stroke
  std::vector<std::string> demands;  // each as text, with its reason
  std::vector<std::string> assumed;  // how a design is scaled, and what is left out
  std::vector<FigurePanel> panels;
  std::size_t evaluated = 0;
  double seconds = 0.0;
  bool interrupted = false;  // before the search was complete
};

}  // namespace biopsy
