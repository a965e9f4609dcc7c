// Other ways to answer what a model lacks, on the same data and scored by the same table. Each is built as
// its own school would build it; none knows what was hidden.
#pragma once

#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/dataset.hpp"
#include "sim/plant/plant_model.hpp"
#include "tests/sim/gap/gap_score.hpp"

namespace biopsy::bench {

// Every number of the baseline let go and fitted to the training runs by least squares, no effect at all.
// Answers `parameter` where the held-out RMSE falls by more than 5 %, naming what left its 95 % interval.
hidden::Answer fit_all_parameters(const sim::Dataset& data, const sim::PlantModel& model);

// Forward selection over the same library with the same fits, but by the textbook: least N ln(mean square)
// + k ln N on the training runs, N all their readings, as if their errors were independent. To three effects.
hidden::Answer select_naively(const sim::Dataset& data, const sim::PlantModel& model);

// Sparse identification (Brunton, Proctor, Kutz, PNAS 2016): the balance of forces on plate A
// (gap_balance.hpp), regressed on a dictionary of quantities by sequentially thresholded least squares; the
// threshold is the one whose terms predict the held-out runs best. What plate B does is taken from its
// recording, or from the baseline. Terms that survive are read as effects of the library.
hidden::Answer regress_sparsely(const sim::Dataset& data, const sim::PlantModel& model);

// RMSE of the held-out runs with either model into an answer, mm. Shared by the three.
void mark(hidden::Answer& answer, const sim::PlantModel& before, const sim::PlantModel& after,
          const sim::gap::Evidence& evidence);

}  // namespace biopsy::bench
