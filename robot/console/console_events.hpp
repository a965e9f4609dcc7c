// From the robot's values to what the page is told.
#pragma once

#include <console_messages.hpp>  // generated from robot/msg/console.idl
#include <optional>

#include "robot/procedure/prepared_case.hpp"
#include "robot/report/procedure/run_record.hpp"

namespace biopsy::robot {

console::events::Series series_of(const Volume& image);

// The points that are set, and what the planner made of them; `prepared.plan` counts only where both are.
console::events::Planned planned_of(const PreparedCase& prepared, const std::optional<Point>& p_SE,
                                    const std::optional<Point>& p_ST, bool confirmed);

console::events::Checked checked_of(std::size_t stage, const report::StepResult& result);

std::array<double, 3> ras_of(const Point& p_S);

}  // namespace biopsy::robot
