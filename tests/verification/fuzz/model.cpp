// Model files: what is read can be written and read again unchanged, and can be run.
#include <cmath>

#include "sim/plant/model_file.hpp"
#include "sim/plant/model_text.hpp"
#include "sim/plant/plant.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(model) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  reads_or_refuses([&] {
    const sim::NotedModel read = sim::parse_noted_model(text_of(bytes), "m.toml");
    const std::string written = sim::model_toml(read.model, read.notes);
    const sim::NotedModel again = sim::parse_noted_model(written, "written.toml");
    claim(sim::model_toml(again.model, again.notes) == written, "written anew it is the same");
    sim::PlantState state = sim::at_rest(read.model);
    for (int tick = 0; tick < 3; ++tick)
      state = sim::step(read.model, state, {.voltage = 5000.0}, Seconds(1e-3));
    claim(std::isfinite(state.motion.x), "a model that was read can be run");
  });
}
