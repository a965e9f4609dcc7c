#include "sim/faults/fault_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "robot/common/config_error.hpp"
#include "robot/common/files/toml_reader.hpp"

namespace biopsy::sim {
namespace {

constexpr double kLatest_s = 600.0;  // no rehearsal is longer
constexpr double kDeepest_mm = 50.0;
constexpr double kLongest_ms = 1000.0;
constexpr std::uint32_t kLongestPhase_ms = 600'000;

constexpr std::array<std::string_view, 14> kSignals{
    "depth",   "depth_b", "voltage_monitor", "current_monitor", "drive",   "brake",     "measurement",
    "request", "permit",  "estop_a",         "estop_b",         "arm_key", "reset_key", "relay"};
constexpr std::array<std::string_view, 14> kKinds{
    "frozen", "replay",      "offset",           "scale",   "drift",
    "lag",    "quantised",   "inverted",         "dropout", "other_surface",
    "noise",  "oscillation", "missing_polarity", "command"};

template <class Name, std::size_t size>
Name named(TomlTable& table, std::string_view entry, const std::array<std::string_view, size>& names) {
  const std::string text = table.text(entry);
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end())
    table.refuse(entry, fmt::format("is \"{}\", which is not known", text),
                 fmt::format("one of: {}", fmt::join(names, ", ")));
  return static_cast<Name>(found - names.begin());
}

struct Unit {
  std::string_view name;
  double most;  // magnitude of a value
};

Unit unit_of(FaultSignal signal) {
  switch (signal) {
    case FaultSignal::Depth:
    case FaultSignal::DepthB:
      return {"mm", kDeepest_mm};
    case FaultSignal::VoltageMonitor:
    case FaultSignal::Drive:
      return {"V", 20'000.0};
    case FaultSignal::CurrentMonitor:
      return {"A", 0.1};
    case FaultSignal::Brake:
      return {"", 1.0};
    default:
      return {"", is_contact(signal) ? 1.0 : 0.0};
  }
}

bool is_possible(FaultSignal signal, FaultKind kind) {
  using enum FaultKind;
  if (is_link(signal)) return kind == Frozen || kind == Lag || kind == Dropout;
  if (signal == FaultSignal::Brake) return kind == Frozen || kind == Lag || kind == Dropout || kind == Scale;
  if (is_contact(signal)) return kind == Frozen || kind == Inverted || kind == OtherSurface;
  if (kind == Command) return signal == FaultSignal::VoltageMonitor;
  return kind != OtherSurface || signal == FaultSignal::Depth || signal == FaultSignal::DepthB;
}

struct Range {
  double low, high;
  std::string unit;
};

// The value's; none: the kind has no value.
std::optional<Range> range_of(FaultKind kind, const Unit& signal) {
  using enum FaultKind;
  const std::string unit(signal.name);
  switch (kind) {
    case Replay:
    case Lag:
      return {{1.0, kLongest_ms, "ms"}};
    case Offset:
    case OtherSurface:
      return {{-signal.most, signal.most, unit}};
    case Drift:
      return {{-signal.most, signal.most, unit + "/s"}};
    case Scale:
      return {{-10.0, 10.0, ""}};
    case Quantised:
      return {{1e-9, signal.most, unit}};
    case Oscillation:
      return {{0.0, signal.most, unit}};
    case Dropout:
      return {{0.0, 1.0, ""}};
    case MissingPolarity:
      return {{-1.0, 1.0, ""}};
    default:
      return {};
  }
}

// An entry that changes nothing would be rehearsed as a fault that nobody noticed.
void refuse_without_effect(TomlTable& table, const Fault& fault) {
  using enum FaultKind;
  if (fault.kind == Noise && !(fault.noise > 0.0))
    table.refuse("kind", "is \"noise\" without noise", "give its standard deviation as `noise`");
  if (fault.kind == MissingPolarity && fault.value == 0.0)
    table.refuse("value", "is 0", "1: the positive sign is lost, -1: the negative one");
  if (is_contact(fault.signal) && fault.kind == OtherSurface && fault.value != 0.0 && fault.value != 1.0)
    table.refuse("value", "is no state of a contact", "0: open, 1: closed");
}

// Of an intermittent fault.
std::int32_t phase_ms(TomlTable& table, std::string_view entry) {
  const std::uint32_t ms = table.whole_number(entry, kLongestPhase_ms);
  if (ms == 0) table.refuse(entry, "is 0", "give both on_ms and off_ms, 1 or more, or neither");
  return static_cast<std::int32_t>(ms);
}

Fault read_fault(TomlTable& table) {
  Fault fault;
  fault.signal = named<FaultSignal>(table, "signal", kSignals);
  fault.kind = named<FaultKind>(table, "kind", kKinds);
  if (!is_possible(fault.signal, fault.kind))
    table.refuse("kind", fmt::format("cannot be \"{}\" on {}", name_of(fault.kind), name_of(fault.signal)),
                 "links: frozen, lag, dropout; brake: these and scale; contacts: frozen, inverted, "
                 "other_surface (0 open, 1 closed); "
                 "other_surface elsewhere: depth and depth_b only; command: voltage_monitor only");
  const Unit unit = unit_of(fault.signal);
  const auto range = range_of(fault.kind, unit);
  if (range)
    fault.value = table.number("value", range->low, range->high, range->unit);
  else if (table.has("value"))
    table.number("value", -unit.most, unit.most,
                 unit.name);  // allowed, without a meaning: frozen, inverted, noise
  const bool is_digital =
      is_link(fault.signal) || is_contact(fault.signal) || fault.signal == FaultSignal::Brake;
  if (table.has("noise")) fault.noise = table.number("noise", 0.0, is_digital ? 0.0 : unit.most, unit.name);
  refuse_without_effect(table, fault);
  if (table.has("on_ms") || table.has("off_ms")) {
    fault.on_ms = phase_ms(table, "on_ms");
    fault.off_ms = phase_ms(table, "off_ms");
  }
  if (table.has("from_depth_mm"))
    fault.from_depth_mm = table.number("from_depth_mm", -kDeepest_mm, kDeepest_mm, "mm");
  if (table.has("from_s")) fault.from_s = table.number("from_s", 0.0, kLatest_s, "s");
  if (table.has("until_s")) {
    fault.until_s = table.number("until_s", 0.0, kLatest_s, "s");
    if (*fault.until_s <= fault.from_s.value_or(0.0))
      table.refuse("until_s", "is not after the beginning", "give a time after from_s, counted from arming");
  }
  return fault;
}

}  // namespace

std::string_view name_of(FaultSignal signal) {
  return kSignals[static_cast<std::size_t>(signal)];
}

std::string_view name_of(FaultKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

std::vector<Fault> parse_faults(const std::string& text, const std::string& file_name) {
  return parse_toml(text, file_name, [&](TomlTable& root) {
    std::vector<Fault> faults;
    for (TomlTable& table : root.tables("fault")) faults.push_back(read_fault(table));
    if (faults.empty())
      throw ConfigError("no [[fault]] in the file", file_name, "give at least one, with signal and kind");
    if (faults.size() > kMostFaults)
      throw ConfigError(fmt::format("{} faults in one file", faults.size()), file_name,
                        fmt::format("give at most {}; several files are several rehearsals", kMostFaults));
    return faults;
  });
}

std::vector<Fault> read_faults(const std::filesystem::path& file) {
  return parse_faults(read_file(file, "give the path of a TOML file of faults"), file.string());
}

}  // namespace biopsy::sim
