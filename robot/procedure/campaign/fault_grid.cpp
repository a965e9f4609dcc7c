#include "robot/procedure/campaign/fault_grid.hpp"

#include <fmt/format.h>

#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

namespace biopsy::robot {
namespace {

using sim::Fault;
using sim::FaultKind;
using sim::FaultSignal;

using Phases = std::vector<std::pair<std::int32_t, std::int32_t>>;  // ms on, ms off

struct Grid {
  std::vector<FaultEntry> entries;

  // One entry a size. `noise`: of what the fault shows.
  void add(FaultSignal signal, FaultKind kind, std::string_view unit, FaultBegin begin,
           std::initializer_list<double> sizes, double noise = 0.0) {
    for (const double size : sizes)
      entries.push_back(
          {fmt::format("{} {} {:g}{}{}{}", name_of(signal), name_of(kind), size, unit.empty() ? "" : " ",
                       unit, begin == FaultBegin::Start ? ", from the start" : ""),
           begin,
           {Fault{.signal = signal, .kind = kind, .value = size, .noise = noise}}});
  }
  // Sizes of the noise.
  void add_noisy(FaultSignal signal, FaultKind kind, std::string_view unit,
                 std::initializer_list<double> noises) {
    for (const double noise : noises)
      entries.push_back({fmt::format("{} {}, noise {:g} {}", name_of(signal), name_of(kind), noise, unit),
                         FaultBegin::Motion,
                         {Fault{.signal = signal, .kind = kind, .noise = noise}}});
  }
  // Comes and goes: shows for `on` ms, not for `off` ms.
  void add_intermittent(Fault fault, std::string_view unit, const Phases& phases) {
    for (const auto& [on, off] : phases) {
      fault.on_ms = on, fault.off_ms = off;
      entries.push_back(
          {fmt::format("{} {} {:g}{}{}, {} ms of {}", name_of(fault.signal), name_of(fault.kind), fault.value,
                       unit.empty() ? "" : " ", unit, on, on + off),
           FaultBegin::Motion,
           {fault}});
    }
  }
  void add_plain(FaultSignal signal, FaultKind kind, FaultBegin begin) {
    entries.push_back({fmt::format("{} {}{}", name_of(signal), name_of(kind),
                                   begin == FaultBegin::Start ? ", from the start" : ""),
                       begin,
                       {Fault{.signal = signal, .kind = kind}}});
  }
};

void add_depth(Grid& grid) {
  using enum FaultKind;
  using enum FaultBegin;
  constexpr FaultSignal kDepth = FaultSignal::Depth;
  grid.add_plain(kDepth, Frozen, Motion);
  grid.add_noisy(kDepth, Frozen, "mm", {0.001, 0.003, 0.01, 0.03, 0.05});
  grid.add(kDepth, Replay, "ms", Motion, {20, 50, 100, 200, 500});
  for (const FaultBegin begin : {Start, Motion}) {
    grid.add(kDepth, Offset, "mm", begin, {-5, -2, -1, -0.5, -0.2, -0.1, 0.1, 0.2, 0.5, 1, 2, 5});
    grid.add(kDepth, Scale, "", begin, {0.5, 0.6, 0.7, 0.8, 0.9, 1.1, 1.2, 1.5});
    grid.add(kDepth, Lag, "ms", begin, {2, 5, 10, 20, 50, 100, 200});
    grid.add_plain(kDepth, Inverted, begin);
  }
  grid.add(kDepth, Drift, "mm/s", Motion,
           {-10, -3, -1, -0.3, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.3, 1, 3, 10});
  grid.add(kDepth, Quantised, "mm", Motion, {0.01, 0.05, 0.1, 0.5, 1});
  grid.add(kDepth, OtherSurface, "mm", Motion, {-2, 0, 0.5, 1, 2, 4, 8}, 0.02);
  grid.add(kDepth, Dropout, "", Motion, {0.01, 0.1, 0.3, 0.6, 0.9, 1});
  grid.add_noisy(kDepth, Noise, "mm", {0.05, 0.1, 0.3, 1});
  const Phases phases{{9, 1}, {5, 5}, {1, 1}, {1, 5}, {200, 50}};
  for (const double surface_mm : {0.5, 1.0, 2.0})
    grid.add_intermittent({.signal = kDepth, .kind = OtherSurface, .value = surface_mm, .noise = 0.01}, "mm",
                          phases);
  grid.add_intermittent({.signal = kDepth, .kind = Offset, .value = -1.0}, "mm", phases);
  grid.add_intermittent({.signal = kDepth, .kind = Drift, .value = -0.5}, "mm/s", phases);
  grid.add_intermittent({.signal = kDepth, .kind = Dropout, .value = 1.0}, "",
                        {{2, 1}, {1, 1}, {1, 5}, {20, 200}});
}

void add_monitors(Grid& grid) {
  using enum FaultKind;
  using enum FaultBegin;
  constexpr FaultSignal kVoltage = FaultSignal::VoltageMonitor, kCurrent = FaultSignal::CurrentMonitor;
  grid.add(kVoltage, Scale, "", Motion, {0, 0.5, 0.8, 0.9, 0.98, 1.02, 1.1, 1.5});
  grid.add(kVoltage, Offset, "V", Motion, {-1000, -200, -50, 50, 200, 1000});
  grid.add_plain(kVoltage, Frozen, Motion);
  grid.add(kVoltage, Lag, "ms", Motion, {2, 10, 50, 200});
  // Wired to the command in place of the output, which nobody then sees.
  for (const double output : {0.0, 0.5, 0.8, 1.2, 1.5})
    grid.entries.push_back({fmt::format("voltage_monitor command, drive scale {:g}", output),
                            Motion,
                            {Fault{.signal = kVoltage, .kind = Command},
                             Fault{.signal = FaultSignal::Drive, .kind = Scale, .value = output}}});
  grid.add(kCurrent, Scale, "", Start, {0, 0.5, 2});
  grid.add(kCurrent, Scale, "", Motion, {0, 0.5, 2});
}

void add_drive(Grid& grid) {
  using enum FaultKind;
  using enum FaultBegin;
  constexpr FaultSignal kDrive = FaultSignal::Drive;
  for (const FaultBegin begin : {Start, Motion})
    grid.add(kDrive, Scale, "", begin, {0, 0.5, 0.8, 0.9, 0.98, 1.02, 1.1, 1.2, 1.5});
  grid.add_plain(kDrive, Frozen, Motion);
  grid.add(kDrive, Drift, "V/s", Motion, {-2000, -500, -100, 100, 500, 2000});
  grid.add(kDrive, Oscillation, "V", Motion, {50, 200, 500, 1000, 2000});
  grid.add(kDrive, MissingPolarity, "", Motion, {-1, 1});
  grid.add(kDrive, Dropout, "", Motion, {0.1, 0.5, 1});
  for (const double weak : {0.5, 0.8, 1.2})  // in every second half-period
    grid.add_intermittent({.signal = kDrive, .kind = Scale, .value = weak}, "", {{250, 250}, {2, 1}});
  grid.add(kDrive, Lag, "ms", Motion, {2, 10, 50});
}

// Frozen: from its first hold, some seconds after arming, locked; before that it never locks.
void add_brake(Grid& grid) {
  using enum FaultKind;
  using enum FaultBegin;
  constexpr FaultSignal kBrake = FaultSignal::Brake;
  grid.add_plain(kBrake, Frozen, Start);
  for (const double from_s : {10.0, 20.0, 40.0})
    grid.entries.push_back({fmt::format("brake frozen {:g} s after arming", from_s),
                            Start,
                            {Fault{.signal = kBrake, .kind = Frozen, .from_s = from_s}}});
  grid.add(kBrake, Scale, "", Start, {0, 0.02, 0.05, 0.1, 0.2, 0.5});
  grid.add(kBrake, Dropout, "", Start, {0.01, 0.1, 0.5});
  grid.add(kBrake, Lag, "ms", Start, {5, 50, 200, 1000});
}

}  // namespace

std::vector<FaultEntry> fault_grid() {
  Grid grid;
  add_depth(grid);
  add_monitors(grid);
  add_drive(grid);
  add_brake(grid);
  return grid.entries;
}

}  // namespace biopsy::robot
