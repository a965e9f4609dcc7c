#include "sim/gap/fit/library.hpp"

#include <type_traits>

namespace biopsy::sim::gap {
namespace {

template <class Effect, class Model>
auto& slot_of(Model& model) {
  std::conditional_t<std::is_const_v<Model>, const std::optional<Effect>, std::optional<Effect>>* found =
      nullptr;
  for_each_effect(model.effects, [&](auto& slot) {
    if constexpr (std::is_same_v<typename std::decay_t<decltype(slot)>::value_type, Effect>) found = &slot;
  });
  return *found;
}

template <class Effect>
LibraryEffect describe() {
  LibraryEffect out{
      .info = Effect::info,
      .parameters = {},
      .present = [](const PlantModel& model) { return slot_of<Effect>(model).has_value(); },
      .add = [](PlantModel& model) { slot_of<Effect>(model).emplace(); },
      .remove = [](PlantModel& model) { slot_of<Effect>(model).reset(); },
      .get = [](const PlantModel& model,
                std::size_t i) { return (*slot_of<Effect>(model)).*(Effect::parameters()[i].member); },
      .set = [](PlantModel& model, std::size_t i,
                double si) { (*slot_of<Effect>(model)).*(Effect::parameters()[i].member) = si; }};
  for (const auto& p : Effect::parameters())
    out.parameters.push_back({p.name, p.meaning, p.si_per_unit, p.low * p.si_per_unit, p.high * p.si_per_unit,
                              p.typical * p.si_per_unit, p.role});
  return out;
}

}  // namespace

const std::vector<LibraryEffect>& library() {
  static const std::vector<LibraryEffect> all = [] {
    std::vector<LibraryEffect> effects;
    Effects slots;
    for_each_effect(slots, [&](auto& slot) {
      using Effect = typename std::decay_t<decltype(slot)>::value_type;
      if constexpr (!std::is_same_v<Effect, SensorNoise>) effects.push_back(describe<Effect>());
    });
    return effects;
  }();
  return all;
}

}  // namespace biopsy::sim::gap
