// The C functions of NI-DAQmx that the stage uses, loaded at run time: without the vendor's driver the
// program builds, and everything but this stage runs. Types and constants as in NI's NIDAQmx.h for 64-bit
// Linux.
#pragma once

#include <cstdint>
#include <string>

namespace biopsy::nidaqmx {

using TaskHandle = void*;
using Status = std::int32_t;  // < 0: error, > 0: warning

inline constexpr std::int32_t kRse = 10083, kDiff = 10106;  // terminal configurations
inline constexpr std::int32_t kVolts = 10348;
inline constexpr std::int32_t kChanForAllLines = 1;
inline constexpr std::uint32_t kGroupByChannel = 0;
inline constexpr std::int32_t kTaskCommit = 3;

struct DaqmxFunctions {
  Status (*get_extended_error_info)(char* text, std::uint32_t size);
  Status (*get_sys_dev_names)(char* names, std::uint32_t size);
  Status (*get_dev_product_type)(const char* device, char* text, std::uint32_t size);
  Status (*get_dev_serial_num)(const char* device, std::uint32_t* serial);
  Status (*reset_device)(const char* device);
  Status (*self_test_device)(const char* device);
  Status (*create_task)(const char* name, TaskHandle* task);
  Status (*task_control)(TaskHandle task, std::int32_t action);
  Status (*start_task)(TaskHandle task);
  Status (*stop_task)(TaskHandle task);
  Status (*clear_task)(TaskHandle task);
  Status (*create_ai_voltage_chan)(TaskHandle task, const char* channel, const char* name,
                                   std::int32_t terminal, double low, double high, std::int32_t units,
                                   const char* scale);
  Status (*create_ao_voltage_chan)(TaskHandle task, const char* channel, const char* name, double low,
                                   double high, std::int32_t units, const char* scale);
  Status (*create_di_chan)(TaskHandle task, const char* lines, const char* name, std::int32_t grouping);
  Status (*create_do_chan)(TaskHandle task, const char* lines, const char* name, std::int32_t grouping);
  Status (*read_analog_f64)(TaskHandle task, std::int32_t samples, double timeout_s, std::uint32_t layout,
                            double* volts, std::uint32_t size, std::int32_t* read, std::uint32_t* reserved);
  Status (*read_digital_scalar_u32)(TaskHandle task, double timeout_s, std::uint32_t* lines,
                                    std::uint32_t* reserved);
  Status (*write_analog_scalar_f64)(TaskHandle task, std::uint32_t auto_start, double timeout_s, double volts,
                                    std::uint32_t* reserved);
  Status (*write_digital_scalar_u32)(TaskHandle task, std::uint32_t auto_start, double timeout_s,
                                     std::uint32_t lines, std::uint32_t* reserved);
};

// `library`: a path, or a name for the system's search. Never unloaded: the vendor's driver has threads of
// its own. Throws ConfigError where it is absent or lacks a function.
DaqmxFunctions load_daqmx(const std::string& library);

}  // namespace biopsy::nidaqmx
