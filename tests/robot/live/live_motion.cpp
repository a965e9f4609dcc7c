#include "tests/robot/live/live_motion.hpp"

#include "robot/procedure/operator.hpp"

namespace biopsy::live_tests {
namespace {

constexpr std::int64_t kTicksMax = 30'000;
constexpr std::int64_t kMoving_ticks = 300;

}  // namespace

Motion move(robot::LiveSession& session, const Plan& plan, std::int64_t ticks) {
  robot::Operator person(plan, robot::kFastScan);
  robot::CycleRecord seen;
  std::int64_t moved = 0;
  for (std::int64_t number = 0; number < kTicksMax && !person.done(); ++number) {
    const robot::OperatorInputs inputs = person.act(seen, number);
    if (person.wants_verdict()) return {{}, "it wanted an image first"};
    const std::optional<robot::CycleSample> cycle = session.robot().tick(inputs);
    if (!cycle) return {{}, "no tick of the stage came"};
    seen = cycle->record;
    moved = seen.supervisor.permit.mode == Mode::Active ? moved + 1 : 0;
    if (moved > ticks && seen.drive_mV != 0) return {inputs, {}};
  }
  return {{}, "the needle never moved: " + person.stopped_because()};
}

MovingRobot moving_robot(const robot::LiveOptions& options, const robot::PreparedCase& prepared,
                         const std::filesystem::path& folder) {
  const Plan& plan = std::get<Plan>(prepared.plan);
  auto session =
      std::make_unique<robot::LiveSession>(options, "sim", robot::HardwareOptions{}, prepared, folder);
  session->wait_until_healthy();
  session->send_plan(plan);
  const Motion motion = move(*session, plan, kMoving_ticks);
  if (!motion.pressing) return {nullptr, motion.prevented_by};
  return {std::move(session), {}};
}

}  // namespace biopsy::live_tests
