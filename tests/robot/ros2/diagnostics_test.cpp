#include "robot/ros2/diagnostics.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace biopsy::ros2 {
namespace {

Diagnostic named(const RobotState& state, const std::string& name) {
  const std::vector<Diagnostic> all = diagnostics_of(state);
  const auto found = std::ranges::find(all, name, &Diagnostic::name);
  EXPECT_NE(found, all.end()) << name;
  return found == all.end() ? Diagnostic{} : *found;
}

TEST(Ros2Diagnostics, ASilentRobotIsStaleInEveryPart) {
  const std::vector<Diagnostic> all = diagnostics_of({});
  EXPECT_EQ(all.size(), 6U);
  for (const Diagnostic& one : all) EXPECT_EQ(one.level, DiagnosticLevel::Stale) << one.name;
}

TEST(Ros2Diagnostics, EveryModeHasItsLevel) {
  const std::map<Mode, DiagnosticLevel> expected{
      {Mode::Boot, DiagnosticLevel::Ok},      {Mode::Safe, DiagnosticLevel::Ok},
      {Mode::Ready, DiagnosticLevel::Ok},     {Mode::Armed, DiagnosticLevel::Ok},
      {Mode::Active, DiagnosticLevel::Ok},    {Mode::Hold, DiagnosticLevel::Warn},
      {Mode::Retract, DiagnosticLevel::Warn}, {Mode::Trip, DiagnosticLevel::Error},
      {Mode::Lock, DiagnosticLevel::Error}};
  for (const auto& [mode, level] : expected) {
    RobotState state;
    state.decision = Decision{.mode = mode};
    EXPECT_EQ(named(state, "biopsy: supervisor").level, level) << static_cast<int>(mode);
  }
}

TEST(Ros2Diagnostics, AnInvalidDepthSensorIsAnError) {
  RobotState state;
  state.measurement = Measurement{.laser_valid = false};
  EXPECT_EQ(named(state, "biopsy: needle").level, DiagnosticLevel::Error);
  state.measurement->laser_valid = true;
  EXPECT_EQ(named(state, "biopsy: needle").level, DiagnosticLevel::Ok);
}

TEST(Ros2Diagnostics, DoNotTellWhoOperates) {
  RobotState state;
  state.health[static_cast<std::size_t>(Process::Person)].seq = 1;
  state.health[static_cast<std::size_t>(Process::Person)].note = "Dr. Roe";
  for (const Diagnostic& one : diagnostics_of(state))
    for (const auto& [key, value] : one.values) EXPECT_EQ(value.find("Roe"), std::string::npos) << one.name;
}

}  // namespace
}  // namespace biopsy::ros2
