// Sound recordings of models that lack something are searched. Data of generator/, which shares no code with
// sim/.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "sim/gap/examine/examine.hpp"
#include "sim/gap/select/evidence_runs.hpp"
#include "sim/plant/model_file.hpp"
#include "tests/sim/gap/generator/hidden_data.hpp"

namespace biopsy::hidden {
namespace {

// No effect of the library, and nothing that is outside it, looks like a damaged recording.
TEST(UndamagedRecording, WithAnyHiddenEffectIsNotBlocked) {
  std::vector<std::string> blocked;
  for (HiddenCase one : hidden_cases()) {
    if (!one.force_drive) one.length = std::min(one.length, 0.4);
    const sim::Dataset data = make_hidden(one);
    const sim::PlantModel model = sim::parse_model(baseline_model(one), "model.toml");
    for (const DataRemark& remark : sim::gap::examine(data, model, sim::gap::noise_of(data)))
      if (remark.blocks) blocked.push_back(one.name + ": " + remark.sentence);
  }
  EXPECT_TRUE(blocked.empty()) << fmt::format("{}", fmt::join(blocked, "\n"));
}

// One that lifts plate A like a weight that is not there, or presses on it like one that is twice as large.
TEST(UndamagedRecording, WithAConstantForceBesideItsWeightsIsNotBlocked) {
  for (const double force : {-0.4, -0.3, -0.2, -0.15, -0.1, 0.1, 0.2, 0.3}) {
    HiddenCase one;
    one.kind = HiddenKind::Single;
    one.terms = {{"external_force", force}};
    one.seed = 4711;
    one.length = 0.35;
    const sim::Dataset data = make_hidden(one);
    const sim::PlantModel model = sim::parse_model(baseline_model(one), "model.toml");
    for (const DataRemark& remark : sim::gap::examine(data, model, sim::gap::noise_of(data)))
      EXPECT_FALSE(remark.blocks) << force << ": " << remark.sentence;
  }
}

}  // namespace
}  // namespace biopsy::hidden
