#include "robot/report/procedure/run_csv.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "robot/common/files/whole_file.hpp"
#include "robot/report/procedure/labels.hpp"

namespace biopsy::report {
namespace {

constexpr const char* kSimulatedHeader =
    "time_s,voltage_V,displacement_mm,plate_b_mm,current_uA,setpoint_mm,tip_mm,envelope_kV,monitor_kV,mode,"
    "stop,stage,gate\n";
constexpr const char* kMeasuredHeader =
    "time_s,voltage_V,displacement_mm,current_uA,setpoint_mm,envelope_kV,monitor_kV,mode,stop,stage,gate\n";

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

using Rows = fmt::memory_buffer;

void append_labels(Rows& rows, const Sample& s) {
  fmt::format_to(std::back_inserter(rows), FMT_COMPILE("{},{},{},{}\n"), label(s.mode), label(s.stop),
                 s.stage + 1, label(s.verdict));
}

void append_simulated(Rows& rows, const Sample& s) {
  fmt::format_to(std::back_inserter(rows),
                 FMT_COMPILE("{:.3f},{:.3f},{:.5f},{:.5f},{:.3f},{:.5f},{:.5f},{:.6f},{:.6f},"),
                 s.time_ms * 1e-3, mV(s.drive_kV) * 1e3, um10(s.depth_mm), um10(s.plate_b_mm),
                 nA(s.current_uA), um10(s.setpoint_mm), um10(s.tip_mm), mV(s.envelope_kV), mV(s.monitor_kV));
  append_labels(rows, s);
}

void append_measured(Rows& rows, const Sample& s) {
  fmt::format_to(std::back_inserter(rows), FMT_COMPILE("{:.3f},{:.3f},{:.5f},{:.3f},{:.5f},{:.6f},{:.6f},"),
                 s.time_ms * 1e-3, mV(s.drive_kV) * 1e3, um10(s.depth_mm), nA(s.current_uA),
                 um10(s.setpoint_mm), mV(s.envelope_kV), mV(s.monitor_kV));
  append_labels(rows, s);
}

}  // namespace

std::string run_csv(const RunRecord& record) {
  Rows rows;
  rows.reserve(128 + record.samples.size() * 128);
  fmt::format_to(std::back_inserter(rows), "{}", record.simulated ? kSimulatedHeader : kMeasuredHeader);
  for (const Sample& sample : record.samples)
    record.simulated ? append_simulated(rows, sample) : append_measured(rows, sample);
  return fmt::to_string(rows);
}

void save_run_csv(const RunRecord& record, const std::filesystem::path& path) {
  atomic_write(path, run_csv(record));
}

}  // namespace biopsy::report
