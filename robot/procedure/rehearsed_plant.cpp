#include "robot/procedure/rehearsed_plant.hpp"

#include "sim/plant/model_file.hpp"
#include "sim/tissue/tissue.hpp"

namespace biopsy::robot {

sim::PlantModel rehearsed_plant(const std::filesystem::path& model, const std::filesystem::path& tissues,
                                std::span<const Layer> layers, double weight_g) {
  sim::PlantModel plant = sim::read_model(model);
  plant.tissue = sim::tissue_along(layers, sim::read_tissues(tissues));
  plant.weight = weight_g * 1e-3;
  return plant;
}

}  // namespace biopsy::robot
