// A needle as a magnetic body: what a scanner's field sees of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot/common/frames.hpp"
#include "robot/common/units.hpp"

namespace biopsy::sim {

// Volume susceptibilities (SI, parts per million) from Schenck, Med. Phys. 23 (1996), table III and text.
inline constexpr double kTissueSusceptibility_ppm = -9.05;  // water at body temperature
inline constexpr double kSusceptibilityMax_ppm = 10'000.0;  // some stainless steels; iron is no needle here

struct NeedleMaterial {
  std::string name;
  double susceptibility_ppm = 0.0;
};

// titanium, nitinol, glass (borosilicate), ceramic (zirconia).
const std::vector<NeedleMaterial>& needle_materials();

// Throws ConfigError listing the names when there is no such material.
const NeedleMaterial& needle_material(const std::string& name);

// A solid of revolution in the scanner frame: a shaft with a conical point. It is held by the robot and does
// not follow the patient. A cannula with its stylet in is solid; the tissue is a uniform medium around it.
struct NeedleBody {
  Point p_SE = Point::Zero();          // a point on the axis before the tip, usually the entry
  Point p_ST = Point(0.0, 0.0, 20.0);  // the very tip
  Millimetres diameter{1.27};          // 18 G
  Millimetres tip_length{2.0};         // of the cone; 0: flat end
  Millimetres shaft_length{150.0};     // from the tip to the far end of the metal
  double susceptibility_ppm = 182.0;   // SI
  double surroundings_ppm = kTissueSusceptibility_ppm;

  Direction axis_S() const { return (p_ST - p_SE).normalized(); }  // insertion
  double contrast() const { return (susceptibility_ppm - surroundings_ppm) * 1e-6; }
};

// Throws ConfigError: a number that is not finite, entry and tip in one place, diameter outside [0.2, 5] mm,
// tip_length outside [0, 4 diameters], shaft_length outside [20 diameters, 1000 mm], susceptibility beyond
// kSusceptibilityMax_ppm.
void refuse_bad_needle(const NeedleBody& needle, const std::string& where);

}  // namespace biopsy::sim
