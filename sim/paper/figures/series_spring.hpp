// When the series spring filters: what of plate B's motion reaches plate A, with the guide's friction and
// without.
#pragma once

#include "sim/paper/paper_figure.hpp"
#include "sim/paper/paper_model.hpp"

namespace biopsy::sim::paper {

// Amplitude of plate A over that of plate B, both moving sinusoidally at `frequency` (Hz), for mass m (kg) on
// a spring k (N/m) with damping c_k beside the spring and c_s to the frame (N s/m), without dry friction.
double transmission(double m, double k, double c_k, double c_s, double frequency);

// Resonance of a mass on a spring, Hz. The undamped transmission is below 1 above sqrt(2) times that.
double resonance(double m, double k);

// Panels and shown rows for Fig. 8a.
void add_series_spring(const PaperModel& model, PaperFigure& figure);

}  // namespace biopsy::sim::paper
