// Many stages at once, for campaigns: those that fit into lanes (lanes.hpp) go eight at a time; a lane in
// which plate A stops or breaks away, and every other stage, goes through step(). The states are those of
// step(), to the bit, whatever stands in the other lanes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/plant/lanes.hpp"
#include "sim/plant/stepper.hpp"

namespace biopsy::sim {

class PlantBatch {
 public:
  // At rest; every step takes `period`.
  PlantBatch(std::vector<PlantModel> models, Seconds period);

  std::size_t size() const { return models_.size(); }
  const PlantModel& model(std::size_t i) const { return models_[i]; }
  bool in_lane(std::size_t i) const { return places_[i].block < blocks_.size(); }

  // One step of every stage: volts, and newtons that push plate A down, of stage i at i. An empty
  // `external_force`: none.
  void step(std::span<const double> voltage, std::span<const double> external_force = {});

  double x(std::size_t i) const {  // m, plate A
    const Place& at = places_[i];
    return in_lane(i) ? blocks_[at.block].states.x[at.lane] : states_[i].motion.x;
  }
  PlantState state(std::size_t i) const;

 private:
  struct Place {
    std::size_t block, lane;
  };
  struct Block {
    LaneConstants constants{};
    LaneStates states{};
    LaneInputs inputs{};
    std::array<std::size_t, kLanes> stages{};
    std::size_t used = 0;  // lanes; the others repeat the first
  };
  void put(std::size_t i, Block& block, std::size_t lane);
  void step_block(Block& block);
  void write(const PlantState& state, LaneStates& lanes, std::size_t lane) const;

  Seconds period_;
  std::vector<PlantModel> models_;
  std::vector<Stepper> steppers_;
  std::vector<PlantState> states_;  // what a lane does not hold of a stage in one
  std::vector<Place> places_;       // a block beyond the last: none
  std::vector<Block> blocks_;
  std::uint64_t steps_ = 0;
};

}  // namespace biopsy::sim
