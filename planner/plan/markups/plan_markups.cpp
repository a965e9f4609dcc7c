#include "planner/plan/markups/plan_markups.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "robot/common/text/sanitize_text.hpp"

namespace biopsy::planner {
namespace {

using OrderedJson = nlohmann::ordered_json;

// An identifier, compared by readers: not an address that anything is fetched from.
constexpr const char* kSchema =
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
    "markups-schema-v1.0.3.json#";

OrderedJson control_point(std::size_t number, const std::string& label, const std::string& description,
                          const Point& p_S) {
  return {{"id", std::to_string(number)},
          {"label", label},
          {"description", description},
          {"position", {p_S.x(), p_S.y(), p_S.z()}},
          {"selected", true},
          {"locked", true},  // a plan is not changed by dragging its points
          {"visibility", true},
          {"positionStatus", "defined"}};
}

OrderedJson markup(const char* type, const char* name, OrderedJson points) {
  return {{"type", type},
          {"name", name},
          {"coordinateSystem", "LPS"},
          {"coordinateUnits", "mm"},
          {"locked", true},
          {"fixedNumberOfControlPoints", true},
          {"labelFormat", "%N-%d"},
          {"controlPoints", std::move(points)}};
}

}  // namespace

std::string plan_markups(const Plan& plan) {
  OrderedJson stages = OrderedJson::array();
  for (std::size_t n = 0; n < plan.steps.size(); ++n) {
    const InsertionStep& step = plan.steps[n];
    const Point p_S = plan.X_SR * Point(0.0, 0.0, step.depth.value);
    stages.push_back(control_point(n + 1, fmt::format("stage {}: {:.2f} mm", n + 1, step.depth.value),
                                   plain(step.why), p_S));
  }
  const OrderedJson line =
      OrderedJson::array({control_point(1, "entry", "where the needle tip waits", plan.target.p_SE),
                          control_point(2, "target", "where it shall go", plan.target.p_ST)});
  const OrderedJson file = {
      {"@schema", kSchema},
      {"markups", OrderedJson::array({markup("Line", "plan", line), markup("Fiducial", "stages", stages)})}};
  return file.dump(1) + "\n";
}

}  // namespace biopsy::planner
