// Stages drawn from the calibration's posterior: what is not known of the paper's stage must not stop a
// procedure.
#include "tests/verification/nuisance/drawn_stages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>

#include "robot/common/in_parallel.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "safety/types/transitions.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"
#include "tests/verification/fault_injection/procedure.hpp"

namespace biopsy::fault_injection {
namespace {

constexpr int kStages = 200;
// A few of the weakest stand short of the last step with 8 kV on them: a limit, and no alarm. 0, 2 and 8 of
// 200.
constexpr int kMostComplete = 190;
constexpr std::int64_t kTicksMax = 600'000;
// Of the whole image, in every stage: a tenth of a voxel.
constexpr double kStill_mm = 0.1;

// Nobody has measured this brake: any that holds the needle's weight twice, on any clamp.
sim::Brake drawn_brake(std::uint64_t seed) {
  const auto between = [seed](std::uint64_t number, double low, double high) {
    return low + (high - low) * sim::uniform(sim::hashed(seed, 0x6272616b65), number);
  };
  return {.holding_N = between(0, 2.0, 20.0),
          .stiffness = between(1, 10e3, 100e3),
          .damping = between(2, 1.0, 20.0),
          .engage_s = between(3, 0.0, 0.08),
          .release_s = between(4, 0.0, 0.08)};
}

// Depths of the needle in one image.
struct Still {
  std::int64_t ticks = 0;
  double low_mm = 1e9, high_mm = -1e9;
  void add(double depth_mm) {
    ++ticks;
    low_mm = std::min(low_mm, depth_mm), high_mm = std::max(high_mm, depth_mm);
  }
};

struct Tally {
  int completed = 0, trips = 0, held_out = 0, images = 0;
  double most_motion_mm = 0.0, shortest_s = 1e9;  // of the needle while an image was taken
  double worst_mm = 0.0;                          // true depth beyond the target
  std::vector<std::string> others;
};

Tally rehearsed(const std::string& name) {
  const ScratchFolder folder;
  const robot::PreparedCase prepared = robot::prepare(robot::read_case(name), folder / "");
  const Plan& plan = std::get<Plan>(prepared.plan);
  const std::vector<sim::PlantModel> drawn = drawn_stages(prepared.given.rehearsal.model, kStages, 1);
  const sim::TissueTable tissues = sim::read_tissues(prepared.given.rehearsal.tissues);
  Tally tally;
  std::mutex one;
  in_parallel(drawn.size(), [&](std::size_t i) {
    Scenario scenario;
    scenario.plan = plan;
    scenario.facts = robot::plan_facts(plan, 1);
    scenario.plant = drawn[i];
    scenario.plant.weight = prepared.given.weight.value * 1e-3;
    scenario.plant.tissue = sim::tissue_along(prepared.layers, tissues);
    scenario.plant.brake = drawn_brake(i + 1);
    scenario.noise_seed = i + 1;
    scenario.scan = Seconds(60.0);
    Procedure procedure(scenario);
    double deepest = 0.0;
    bool tripped = false, held_out = false;
    double last_mm = 0.0, last_kV = 0.0;
    Still image;
    std::vector<Still> images;
    for (std::int64_t k = 0; k < kTicksMax && !procedure.over(); ++k) {
      const TickRecord line = procedure.tick();
      if (line.mode == Mode::Active) last_mm = line.depth_mm, last_kV = std::abs(line.output_kV);
      deepest = std::max(deepest, line.depth_mm);
      if (procedure.inputs().acquiring)
        image.add(line.depth_mm);
      else if (image.ticks > 0)
        images.push_back(std::exchange(image, {}));
      tripped |= line.mode == Mode::Trip || line.mode == Mode::Lock;
      held_out |= (line.hazards & bit(safety::Hazard::NeedleNotBack)) != 0;
    }
    const std::lock_guard lock(one);
    for (const Still& taken : images) {
      ++tally.images;
      tally.most_motion_mm = std::max(tally.most_motion_mm, taken.high_mm - taken.low_mm);
      tally.shortest_s = std::min(tally.shortest_s, static_cast<double>(taken.ticks) * 1e-3);
    }
    tally.completed += procedure.simulated_operator().completed();
    tally.trips += tripped;
    tally.held_out += held_out;
    tally.worst_mm = std::max(tally.worst_mm, deepest - plan.target_depth.value);
    if (!procedure.simulated_operator().completed() || tripped)
      tally.others.push_back(fmt::format("stage {}: {}; at last {:.2f} mm at {:.2f} kV", i,
                                         procedure.simulated_operator().stopped_because(), last_mm, last_kV));
  });
  return tally;
}

class DrawnStages : public testing::TestWithParam<const char*> {};

TEST_P(DrawnStages, CompleteTheProcedure) {
  const std::string name = GetParam();
  const bool own = name.ends_with(".toml");
  const Tally tally = rehearsed(own ? (source_dir() / name).string() : name);
  for (const std::string& other : tally.others) std::cout << other << '\n';
  RecordProperty("completed", tally.completed);
  RecordProperty("held_out", tally.held_out);
  std::cout << tally.completed << " of " << kStages << " completed, " << tally.trips << " tripped, "
            << tally.held_out << " not back at 0 V, deepest " << tally.worst_mm << " mm beyond the target\n";
  std::cout << tally.images << " images of at least " << tally.shortest_s
            << " s; the needle moved by at most " << tally.most_motion_mm << " mm in any of them\n";
  EXPECT_GE(tally.images, 2 * kMostComplete / (name == "gap" ? 2 : 1));
  EXPECT_GE(tally.shortest_s, 59.9);
  EXPECT_LT(tally.most_motion_mm, kStill_mm);
  EXPECT_GE(tally.completed, kMostComplete);
  EXPECT_EQ(tally.trips, 0);
  EXPECT_LT(tally.worst_mm, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Cases, DrawnStages, testing::Values("liver", "gap", "docs/examples/case.toml"));

}  // namespace
}  // namespace biopsy::fault_injection
