#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "robot/report/procedure/labels.hpp"
#include "robot/report/procedure/report.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kSimulatedHeader =
    "time_s,voltage_V,displacement_mm,plate_b_mm,current_uA,setpoint_mm,tip_mm,envelope_kV,monitor_kV,mode,"
    "stop,stage,gate,locked\n";
constexpr const char* kMeasuredHeader =
    "time_s,voltage_V,displacement_mm,current_uA,setpoint_mm,envelope_kV,monitor_kV,mode,stop,stage,gate,"
    "locked\n";

// Adding zero turns a rounded -0.0 into 0.0.
double steady(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit + 0.0;
}
double um10(float mm) {
  return steady(mm, 1e5);
}  // 0.01 um
double mV(float kilovolts) {
  return steady(kilovolts, 1e6);
}  // the gate counts in mV
double nA(float microamperes) {
  return steady(microamperes, 1e3);
}

std::string row(const Sample& s, bool simulated) {
  std::string text;
  const auto out = std::back_inserter(text);
  // Milliseconds in lockstep, microseconds of a clock.
  const bool whole = s.time_ms == std::floor(s.time_ms);
  whole ? fmt::format_to(out, FMT_COMPILE("{:.3f},"), s.time_ms * 1e-3)
        : fmt::format_to(out, FMT_COMPILE("{:.6f},"), s.time_ms * 1e-3);
  fmt::format_to(out, FMT_COMPILE("{:.3f},{:.5f},"), mV(s.drive_kV) * 1e3, um10(s.depth_mm));
  if (simulated) fmt::format_to(out, FMT_COMPILE("{:.5f},"), um10(s.plate_b_mm));
  fmt::format_to(out, FMT_COMPILE("{:.3f},{:.5f},"), nA(s.current_uA), um10(s.setpoint_mm));
  if (simulated) fmt::format_to(out, FMT_COMPILE("{:.5f},"), um10(s.tip_mm));
  fmt::format_to(out, FMT_COMPILE("{:.6f},{:.6f},{},{},{},{},{:d}\n"), mV(s.envelope_kV), mV(s.monitor_kV),
                 label(s.mode), label(s.stop), s.step + 1, label(s.verdict), s.locked);
  return text;
}

}  // namespace

std::string run_csv(const RunRecord& record) {
  std::string rows = record.simulated ? kSimulatedHeader : kMeasuredHeader;
  rows.reserve(rows.size() + record.samples.size() * 128);
  for (const Sample& sample : record.samples) rows += row(sample, record.simulated);
  return rows;
}

}  // namespace biopsy::report
