#include "sim/plant/simulate.hpp"

#include "sim/plant/plant.hpp"

namespace biopsy::sim {

RecordedRun simulate(PlantModel model, const RecordedRun& recorded) {
  model.weight = recorded.weight;
  RecordedRun run = recorded;
  const std::size_t rows = run.time.size();
  const bool stack = model.baseline.drive == Drive::Stack;
  run.plate_b.assign(stack ? rows : 0, 0.0);
  run.current.assign(stack ? rows : 0, 0.0);
  PlantState state = at_rest(model);
  double mean_current = 0.0;  // over the row before: a jump of the voltage is a charge without duration
  for (std::size_t i = 0; i < rows; ++i) {
    run.displacement[i] = displacement_reading(model, state);
    if (stack) {
      run.plate_b[i] = plate_b(model, state);
      run.current[i] = mean_current;
    }
    const double until = i + 1 < rows ? run.time[i + 1] - run.time[i] : run.period;
    state = step(model, state,
                 {.voltage = stack ? run.input[i] : 0.0,
                  .force = stack ? 0.0 : run.input[i],
                  .external_force = run.external_force[i]},
                 Seconds(until));
    mean_current = state.charge / until;
  }
  return run;
}

}  // namespace biopsy::sim
