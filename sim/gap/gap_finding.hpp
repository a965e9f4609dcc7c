// Result of comparing a model with measurements: where they disagree, what is missing, and how much of the
// gap it closes. Values only; made by sim/gap, printed by robot/report. Lengths in mm, times in s.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace biopsy {

enum class GapVerdict : std::uint8_t { NoGap, Parameter, Effect, Unexplained };

struct GapEstimate {
  std::string name;  // with its unit, as in model files
  double value = 0.0, std = 0.0;
};

struct GapProbability {
  std::string name;
  double probability = 0.0;
};

struct FoundEffect {
  std::string name;
  std::string sentence;  // of the effect's description
  double probability = 0.0;
  double share_explained = 0.0;  // of the held-out excess squared error, when it entered
  std::vector<GapEstimate> parameters;
  std::vector<GapProbability> confused_with;
};

struct ChangedParameter {
  std::string name;  // of the baseline, SI; or EFFECT.PARAMETER of an effect the model had, in its file unit
  double before = 0.0, after = 0.0, std = 0.0;
};

// A situation within the runs. Shares are of all runs together; a moment may belong to several regimes.
struct GapRegime {
  std::string name;
  double share_of_time = 0.0, share_of_excess_error = 0.0;
  double rmse_before = 0.0, rmse_after = 0.0;
};

enum class CandidateKind : std::uint8_t { Effect, Parameter };

// One candidate. Numbers that were not computed are NaN.
struct GapCandidate {
  std::string name;
  CandidateKind kind = CandidateKind::Effect;
  int round = 1;        // of the forward selection
  double score = 0.0;   // share of the gap the score test promises, training runs
  bool fitted = false;  // otherwise the score test ruled it out
  double held_out_rmse = std::numeric_limits<double>::quiet_NaN();
  double probability = 0.0;  // among the candidates of its round
  bool chosen = false;
};

// One run, thinned for drawing; all vectors of equal length. residual = measured - model.
struct GapTrace {
  std::string run;
  bool held_out = false;
  std::vector<double> time, input, measured, before, after;
  std::vector<std::uint8_t> regime;  // index into regime_names of GapFinding, the main one at each point
};

// How well the models follow one run, or the held-out part of one.
struct RunFit {
  std::string run;
  bool held_out = false;
  double before_percent = 0.0, after_percent = 0.0;  // 100 (1 - |residual| / |motion about its mean|)
  // Of the new model's residual: largest |autocorrelation|, and |correlation| with the input before it, over
  // the first 25 rows; white noise stays below `bound` at 99 % of the lags.
  double whiteness = 0.0, input_correlation = 0.0, bound = 0.0;
};

// Every row of a run; all vectors of equal length. mm, input in V or N.
struct GapSignals {
  std::string run;
  std::size_t training_rows = 0;  // the first so many
  std::vector<double> time, input, measured, before, after;
};

// A model without physics, fitted to the training runs and simulated on the held-out ones.
struct StrawMan {
  std::string name;
  int order = 0;
  double rmse = 0.0;  // mm, held-out runs
};

// Mean of an unexplained residual as a function of one quantity.
struct ResidualShape {
  std::string quantity, unit;
  double share_explained = 0.0;  // of the residual's variance by this curve
  std::vector<double> at, mean, count;
};

struct NextExperiment {
  std::string name;                    // of the menu; empty: none needed
  std::vector<std::string> separates;  // effects
  double difference = 0.0;             // RMS between what they predict there
  std::string sentence;
};

// One figure of a dry-run of a reference plan with the old model and with the new one.
struct MarginChange {
  std::string plan, quantity, unit;
  double limit = 0.0, before = 0.0, after = 0.0;  // used, of the limit
  bool ok = true;                                 // with the new model
};

// Something about the recording that a person should correct, or know, before the result is used.
struct DataRemark {
  std::string cause;    // "unit", "sign", "swapped", "constant", "frozen", "clipped", "quantised", ...
  std::string channel;  // column of the file, or key of dataset.toml
  std::vector<std::string> runs;
  bool blocks = false;   // nothing was searched: an effect would be named for an error of the recording
  std::string sentence;  // what was found and what to do
};

// How model and data were compared, and what is known of the set-up.
struct GapComparison {
  std::vector<std::string> free;  // baseline parameters fitted without a prior
  double window = 0.0;            // s; 0: each run in one piece
  bool chosen = false;            // from the data; otherwise as told
  std::string reason;
  bool tissue = false;        // the needle may meet tissue
  bool tissue_given = false;  // by the data set; otherwise by the drive
};

// What explains most of a gap and was not given as its name.
struct RejectedName {
  std::vector<std::string> effects;
  double gap_closed = 0.0, rmse_after = 0.0;  // mm
  std::vector<std::string> objections;        // clauses
};

// One product of a proposed term, with its coefficient.
struct TermCoefficient {
  std::string name, product, unit;  // "a", "v^3", "N s^3/m^3"
  double value = 0.0, std = 0.0;    // in that unit
  double share = 0.0;               // of the sum of the products' RMS forces over the recording
};

struct TermVariableRange {
  std::string variable, unit;
  double low = 0.0, high = 0.0;
};

// A force for which the library has no effect, found as an equation. Proposed: not the name of anything.
struct ProposedTerm {
  std::string name;        // of [term.NAME]
  std::string expression;  // of the force on plate A, N, up: "a v^3 + b x"
  std::vector<TermCoefficient> coefficients;
  std::vector<TermVariableRange> seen;        // where; outside it the force stays as at the edge
  double memory_s = 0.0, memory_std = 0.0;    // 0: none
  double period_mm = 0.0, period_std = 0.0;   // 0: nothing repeats with position
  double exponent = 0.0, exponent_std = 0.0;  // n of |v|^n; 0: none
  double rmse_before = 0.0, rmse_calibrated = 0.0, rmse_after = 0.0;  // mm, held-out runs
  double gap_closed = 0.0;
  std::string meaning;              // what it may be
  std::vector<std::string> rivals;  // other equations that leave nearly as little
};

struct GapFinding {
  GapVerdict verdict = GapVerdict::NoGap;
  std::string sentence;  // the verdict in words
  std::string dataset;   // its title
  bool force_drive = false;
  bool interrupted = false;          // before the search was complete
  std::vector<FoundEffect> effects;  // in the order found, the strongest first
  std::vector<ChangedParameter> parameters_changed;
  double rmse_before = 0.0, rmse_after = 0.0, noise_floor = 0.0;  // held-out runs
  double noise_std = 0.0;                                         // of an estimated noise floor, mm
  bool noise_given = false;                                       // by the data set; otherwise estimated
  double gap_closed = 0.0;
  bool partial = false;   // the effects stand, but leave more than the noise
  RejectedName rejected;  // of an unexplained gap; no effects: there was no candidate for a name
  std::optional<ProposedTerm> proposed;  // of an unexplained gap
  GapComparison comparison;
  std::vector<GapRegime> where;  // highest concentration of the error first
  std::vector<std::string> regime_names;
  std::vector<GapCandidate> candidates;
  std::vector<GapTrace> traces;
  std::vector<RunFit> fits;
  std::vector<StrawMan> straw_men;
  std::vector<GapSignals> signals;
  std::vector<ResidualShape> shapes;  // best first
  NextExperiment next;
  std::vector<MarginChange> margins;
  std::vector<DataRemark> data;  // found before any fit; those that block first
  std::vector<std::string> held_out_runs, training_runs, warnings;
  std::string model_before, model_after;  // as files
  std::string model_proposed;             // with `proposed`; empty without
  double seconds = 0.0;                   // of work, wall time
};

}  // namespace biopsy
