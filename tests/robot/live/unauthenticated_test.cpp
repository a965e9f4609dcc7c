// A participant on the network of the robot that sends commands without keys, or with keys of another set.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "robot/live/session/live_session.hpp"
#include "robot/procedure/case/case.hpp"
#include "robot/security/make_keys.hpp"
#include "safety/types/hazards.hpp"
#include "tests/robot/live/live_motion.hpp"
#include "tests/robot/live/log_mentions.hpp"
#include "tests/robot/live/steady_host.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live_tests {
namespace {

constexpr std::uint32_t kSecuredDomain = 81;

// The program rogue, while this lives. `keys`: of a controller; empty: none.
class Rogue {
 public:
  explicit Rogue(const std::string& keys) {
    const std::string number = std::to_string(kSecuredDomain);
    char* const arguments[] = {const_cast<char*>(ROGUE), const_cast<char*>(number.c_str()),
                               keys.empty() ? nullptr : const_cast<char*>(keys.c_str()), nullptr};
    EXPECT_EQ(posix_spawn(&pid_, ROGUE, nullptr, nullptr, arguments, environ), 0);
  }
  ~Rogue() {
    EXPECT_EQ(waitpid(pid_, nullptr, WNOHANG), 0) << "it ended by itself, and shouted nothing";
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  Rogue(const Rogue&) = delete;
  Rogue& operator=(const Rogue&) = delete;

 private:
  pid_t pid_ = -1;
};

// Two seconds with the button held: ticks in which the needle was free to move, and what ended that.
struct Moved {
  int active = 0;
  std::string reason;  // the first
};

Moved two_seconds(robot::LiveSession& session) {
  robot::OperatorInputs pressing = robot::OperatorInputs::idle();
  pressing.press = {1, true};
  Moved moved;
  for (int n = 0; n < 2'000; ++n) {
    const std::optional<robot::CycleSample> cycle = session.robot().tick(pressing);
    if (!cycle) return moved;
    moved.active += cycle->record.supervisor.permit.mode == Mode::Active;
    if (const safety::Hazard reason = cycle->record.supervisor.reason;
        moved.reason.empty() && reason != safety::Hazard::None)
      moved.reason = robot::hazard_text(reason, cycle->record.panel_unread_ms);
    EXPECT_NE(cycle->record.supervisor.worst, safety::Hazard::SecondWriter);
  }
  return moved;
}

// The needle moves on while an unauthenticated participant sends, and the log has `words` about it.
void moves_on_and_logs(bool with_keys, const std::string& words) {
  on_a_steady_host([&]() -> std::string {
    const ScratchFolder folder;
    // Before the motion: keys take longer to make than a button counts as held unasked.
    const std::filesystem::path keys = folder.path() / "keys of somebody else";
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    if (with_keys) security::make_keys(keys, 1, now, false);
    const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), folder.path());
    robot::LiveOptions secured;
    secured.domain = kSecuredDomain;
    const MovingRobot moving = moving_robot(secured, prepared, folder.path());
    if (!moving.session) return moving.prevented_by;
    robot::LiveSession& session = *moving.session;
    const Rogue rogue(with_keys ? keys.string() : "");
    const Moved moved = two_seconds(session);
    EXPECT_TRUE(session.stop().empty());
    if (moved.active <= 1'500)
      return fmt::format("the needle was free to move in {} ticks of 2000: {}", moved.active, moved.reason);
    EXPECT_TRUE(tells_of(folder.path(), words));
    return {};
  });
}

TEST(UnauthenticatedParticipant, WithoutKeysIsIgnoredAndLogged) {
  verifies("R-46");
  moves_on_and_logs(false, "endpoints_without_keys");
}

TEST(UnauthenticatedParticipant, WithKeysOfAnotherSetIsIgnoredAndLogged) {
  verifies("R-46");
  moves_on_and_logs(true, "participants_not_let_in");
}

}  // namespace
}  // namespace biopsy::live_tests
