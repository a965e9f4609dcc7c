#include "sim/scanner/susceptibility/needle_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {

const std::vector<NeedleMaterial>& needle_materials() {
  static const std::vector<NeedleMaterial> kMaterials{
      {"titanium", 182.0}, {"nitinol", 245.0}, {"glass", -13.88}, {"ceramic", -8.3}};
  return kMaterials;
}

const NeedleMaterial& needle_material(const std::string& name) {
  std::string known;
  for (const NeedleMaterial& material : needle_materials()) {
    if (material.name == name) return material;
    known += (known.empty() ? "" : ", ") + material.name;
  }
  throw ConfigError(fmt::format("unknown needle material \"{:.40}\"", name), "needle",
                    "choose one of " + known + ", or give susceptibility_ppm");
}

void refuse_bad_needle(const NeedleBody& needle, const std::string& where) {
  const auto require = [&](bool good, const std::string& what, const std::string& remedy) {
    if (!good) throw ConfigError(what, where, remedy);
  };
  require(needle.p_SE.allFinite() && needle.p_ST.allFinite(), "entry or tip is not finite",
          "give points in the scanner frame, mm");
  require((needle.p_ST - needle.p_SE).norm() > 1e-6,
          "entry and tip are one point: the needle has no direction",
          "give a point on the axis before the tip");
  const double d = needle.diameter.value;
  require(d >= 0.2 && d <= 5.0, fmt::format("needle diameter {:g} mm is outside [0.2, 5]", d),
          "give the outer diameter: 18 G is 1.27 mm");
  require(needle.tip_length.value >= 0.0 && needle.tip_length.value <= 4.0 * d,
          fmt::format("tip length {:g} mm is outside [0, 4 diameters]", needle.tip_length.value),
          "give the length of the point alone");
  require(needle.shaft_length.value >= 20.0 * d && needle.shaft_length.value <= 1000.0,
          fmt::format("needle length {:g} mm is outside [20 diameters, 1000 mm]", needle.shaft_length.value),
          "give the length of the metal");
  for (const double ppm : {needle.susceptibility_ppm, needle.surroundings_ppm})
    require(std::abs(ppm) <= kSusceptibilityMax_ppm,
            fmt::format("susceptibility {:g} ppm is beyond +-{:g} ppm", ppm, kSusceptibilityMax_ppm),
            "give the volume susceptibility in SI, parts per million: titanium has 182");
}

}  // namespace biopsy::sim
