// Severities and sources of diagnostic messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace biopsy::logging {

enum class Level : std::uint8_t { Trace, Debug, Info, Warning, Error, Off };

inline constexpr std::array<const char*, 6> kLevelNames{"trace", "debug", "info", "warning", "error", "off"};

// Each has a logger of its own. The last three are libraries.
enum class Component : std::uint8_t {
  Cli,
  Supervisor,
  Controller,
  Stage,
  Interlock,
  Recorder,
  Console,
  Planner,
  Sim,
  Bench,
  Navigation,
  Security,
  Dds,
  Ceres,
  Dcmtk,
  Opencv,
};

inline constexpr std::array<const char*, 16> kComponentNames{
    "cli", "supervisor", "controller", "stage",    "interlock", "recorder", "console", "planner",
    "sim", "bench",      "navigation", "security", "dds",       "ceres",    "dcmtk",   "opencv"};

constexpr const char* name_of(Component component) {
  return kComponentNames[static_cast<std::size_t>(component)];
}

}  // namespace biopsy::logging
