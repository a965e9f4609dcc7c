// An open-loop program asks for its voltages tick by tick, begins with the permit and ends without one.
#include "robot/control/voltage_program.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace biopsy::control {
namespace {

Permit permit_in(Mode mode, std::int32_t v_max_mV = 8'000'000) {
  Permit permit;
  permit.mode = mode;
  permit.hv_enable =
      mode == Mode::Armed || mode == Mode::Active || mode == Mode::Hold || mode == Mode::Retract;
  permit.v_max_mV = mode == Mode::Armed ? 0 : v_max_mV;
  return permit;
}

VoltageProgram up_stand_down() {
  return {.segments = {{100, Volts(0), Volts(1000)},
                       {300, Volts(1000), Volts(1000)},
                       {100, Volts(1000), Volts(0)}},
          .half_period_ticks = 50};
}

// A program and how far it was played.
struct Player {
  VoltageProgram program = up_stand_down();
  ProgramState state;

  DriveRequest tick(const Permit& permit, bool finish = false) {
    const ProgramStep step = play(program, state, permit, finish);
    state = step.state;
    return step.request;
  }
};

TEST(VoltageProgram, IsAsLongAndAsHighAsItsSegments) {
  const VoltageProgram program = up_stand_down();
  EXPECT_EQ(length_ticks(program), 500U);
  EXPECT_EQ(highest(program), Volts(1000));
  EXPECT_EQ(amplitude_at(program, 0), Volts(0));
  EXPECT_EQ(amplitude_at(program, 50), Volts(500));
  EXPECT_EQ(amplitude_at(program, 250), Volts(1000));
  EXPECT_EQ(amplitude_at(program, 425), Volts(750));
  EXPECT_EQ(amplitude_at(program, 500), Volts(0));
  EXPECT_EQ(highest(VoltageProgram{}), Volts(0));
}

TEST(VoltageProgram, WaitsForThePermitThenPlaysEachTickOnce) {
  Player player;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(player.tick(permit_in(Mode::Ready)).wanted_mV, 0);
    EXPECT_EQ(player.tick(permit_in(Mode::Armed)).wanted_mV, 0);
  }
  for (std::uint32_t tick = 0; tick < 500; ++tick) {
    const DriveRequest request = player.tick(permit_in(Mode::Active));
    const int sign = tick / 50 % 2 == 0 ? 1 : -1;
    ASSERT_EQ(request.wanted_mV, sign * to_mV(amplitude_at(player.program, tick))) << tick;
    ASSERT_EQ(request.finished, tick == 499) << tick;
    ASSERT_FALSE(request.step_reached);
  }
  EXPECT_TRUE(is_played(player.program, player.state));
  EXPECT_EQ(player.tick(permit_in(Mode::Active)).wanted_mV, 0);
}

TEST(VoltageProgram, NumbersEveryRequest) {
  Player player;
  for (std::uint32_t i = 1; i <= 30; ++i) {
    const Mode mode = i < 10 ? Mode::Ready : i < 20 ? Mode::Active : Mode::Trip;
    ASSERT_EQ(player.tick(permit_in(mode)).seq, i);
  }
}

TEST(VoltageProgram, OfOneSignNeverTurns) {
  Player player;
  player.program.half_period_ticks = 0;
  player.program.sign = -1;
  for (int i = 0; i < 500; ++i) ASSERT_LE(player.tick(permit_in(Mode::Active)).wanted_mV, 0);
  EXPECT_TRUE(is_played(player.program, player.state));
}

TEST(VoltageProgram, AsksForItsHoldAndPlaysOnInIt) {
  Player player;
  player.program.hold_from_tick = 100;
  for (int i = 0; i < 99; ++i) ASSERT_FALSE(player.tick(permit_in(Mode::Active)).step_reached);
  ASSERT_TRUE(player.tick(permit_in(Mode::Active)).step_reached);
  for (int i = 100; i < 500; ++i) player.tick(permit_in(Mode::Hold));
  EXPECT_TRUE(is_played(player.program, player.state));
}

TEST(VoltageProgram, StopsInAHoldItDidNotAskFor) {
  Player player;
  for (int i = 0; i < 60; ++i) player.tick(permit_in(Mode::Active));
  const std::int32_t reached_mV = to_mV(player.state.amplitude);
  for (int i = 0; i < 200; ++i) ASSERT_EQ(std::abs(player.tick(permit_in(Mode::Hold)).wanted_mV), reached_mV);
  EXPECT_EQ(player.state.ticks, 60U);
}

TEST(VoltageProgram, FollowsTheEnvelopeDownAndNeverUpAgain) {
  Player player;
  for (int i = 0; i < 200; ++i) player.tick(permit_in(Mode::Active));
  const auto asked_within = [&](std::int32_t v_max_mV) {
    return std::abs(player.tick(permit_in(Mode::Retract, v_max_mV)).wanted_mV);
  };
  EXPECT_EQ(asked_within(900'000), 900'000);
  EXPECT_EQ(asked_within(400'000), 400'000);
  EXPECT_EQ(asked_within(600'000), 400'000);
  EXPECT_EQ(asked_within(0), 0);
  EXPECT_TRUE(player.tick(permit_in(Mode::Retract), true).finished);
}

TEST(VoltageProgram, BeginsAnewAfterTheDriveWasOff) {
  Player player;
  for (int i = 0; i < 200; ++i) player.tick(permit_in(Mode::Active));
  player.tick(permit_in(Mode::Trip));
  EXPECT_EQ(player.state.ticks, 0U);
  EXPECT_EQ(player.tick(permit_in(Mode::Active)).wanted_mV, 0);
}

TEST(VoltageProgram, BetweenTwoSegmentsTheLaterOneBegins) {
  const VoltageProgram jump{.segments = {{100, Volts(0), Volts(1000)}, {50, Volts(400), Volts(400)}}};
  EXPECT_EQ(amplitude_at(jump, 100), Volts(400));
  EXPECT_EQ(highest({.segments = {{10, Volts(500), Volts(0)}}}), Volts(500));
  EXPECT_EQ(highest({.segments = {{10, Volts(0), Volts(700)}}}), Volts(700));
}

TEST(VoltageProgram, TurnsEachTickWhereItsHalfPeriodIsOneTick) {
  Player player;
  player.program.half_period_ticks = 1;
  for (int i = 0; i < 200; ++i) player.tick(permit_in(Mode::Active));
  EXPECT_GT(player.tick(permit_in(Mode::Active)).wanted_mV, 0);
  EXPECT_LT(player.tick(permit_in(Mode::Active)).wanted_mV, 0);
}

TEST(VoltageProgram, GoesOnAfterAHoldItDidNotAskForWhereItStopped) {
  Player player;
  player.program.hold_from_tick = 100;
  for (int i = 0; i < 60; ++i) player.tick(permit_in(Mode::Active));
  for (int i = 0; i < 600; ++i) ASSERT_FALSE(player.tick(permit_in(Mode::Hold)).step_reached) << i;
  EXPECT_EQ(player.state.ticks, 60U);
  EXPECT_FALSE(is_played(player.program, player.state));
  EXPECT_EQ(std::abs(player.tick(permit_in(Mode::Active)).wanted_mV), 600'000);
  EXPECT_EQ(player.state.ticks, 61U);
  for (int i = 61; i < 200; ++i)
    ASSERT_EQ(player.tick(permit_in(Mode::Active)).step_reached, i + 1 >= 100) << i;
}

TEST(VoltageProgram, IsPlayedAtItsEndAndBeyond) {
  for (const auto& [ticks, played] : {std::pair{499U, false}, {500U, true}, {501U, true}}) {
    ProgramState state;
    state.ticks = ticks;
    EXPECT_EQ(is_played(up_stand_down(), state), played) << ticks;
  }
}

TEST(VoltageProgram, AsksForNothingUnderALimitBelowZero) {
  Player player;
  for (int i = 0; i < 200; ++i) player.tick(permit_in(Mode::Active));
  EXPECT_EQ(player.tick(permit_in(Mode::Active, -5'000'000)).wanted_mV, 0);
}

}  // namespace
}  // namespace biopsy::control
