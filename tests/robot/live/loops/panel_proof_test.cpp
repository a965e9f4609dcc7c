// The hand at a simulated panel, by the clock.
#include "robot/live/session/panel_proof.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace biopsy::loops_tests {
namespace {

// A stage that was not read yet when the panel was first proven: the supervisor says that it does not count.
TEST(PanelProof, IsRepeatedWhereItDidNotCountAndBegunAnewInASession) {
  robot::PanelProof person;
  const digital_io::PanelLevels asked{.estop_a_closed = true, .estop_b_closed = true};
  const auto presses = [&](const Decision& told, std::int64_t from_us) {
    int pressed = 0, turned = 0;
    for (std::int64_t us = from_us; us < from_us + 1'000'000; us += 5'000) {
      const digital_io::PanelLevels now = person.levels(asked, told, us);
      pressed += !now.estop_a_closed && !now.estop_b_closed;
      turned += now.reset_key && now.estop_a_closed;
    }
    return std::pair(pressed, turned);
  };
  EXPECT_EQ(presses({}, 0), std::pair(0, 0)) << "no supervisor yet";
  Decision told;
  told.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  told.session = 3;
  EXPECT_EQ(presses(told, 1'000'000), std::pair(20, 20));
  EXPECT_EQ(presses(told, 2'000'000), std::pair(0, 0)) << "once";
  told.worst = static_cast<std::uint8_t>(safety::Hazard::PanelUntested);
  EXPECT_GE(presses(told, 3'000'000).first, 20);
  told.worst = static_cast<std::uint8_t>(safety::Hazard::None);
  presses(told, 4'000'000);
  told.session = 4;
  EXPECT_EQ(presses(told, 5'000'000), std::pair(20, 20));
}

}  // namespace
}  // namespace biopsy::loops_tests
