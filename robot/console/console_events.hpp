// Events for the page, from the robot's values.
#pragma once

#include <optional>

#include "robot/msg/console_messages.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

console::events::Series series_of(const Volume& image);

// The points that are set, and the plan or its refusal; `prepared.plan` is used only where both points are
// set.
console::events::Planned planned_of(const PreparedCase& prepared, const std::optional<Point>& p_SE,
                                    const std::optional<Point>& p_ST, bool confirmed);

console::events::Checked checked_of(std::size_t step, const report::StepResult& result);

std::array<double, 3> ras_of(const Point& p_S);

}  // namespace biopsy::robot
