#include "drivers/nidaqmx/daqmx_functions.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "robot/common/config_error.hpp"

namespace biopsy::nidaqmx {
namespace {

constexpr const char* kInstall =
    "install the NI-DAQmx driver for Linux (ni.com/downloads, package ni-daqmx), restart, and see the board "
    "with `nilsdev`; without hardware use --device sim";

class Symbols {
 public:
  explicit Symbols(void* library) : library_(library) {}

  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(library_, name));
    if (function == nullptr) missing_.emplace_back(name);
  }
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  void* library_;
  std::vector<std::string> missing_;
};

}  // namespace

DaqmxFunctions load_daqmx(const std::string& library) {
  void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) {
    const char* const reason = dlerror();
    throw ConfigError(
        fmt::format("the NI-DAQmx driver cannot be loaded: {}", reason ? reason : "no reason given"), library,
        kInstall);
  }
  DaqmxFunctions found{};
  Symbols symbols(handle);
  symbols.find("DAQmxGetExtendedErrorInfo", found.get_extended_error_info);
  symbols.find("DAQmxGetSysDevNames", found.get_sys_dev_names);
  symbols.find("DAQmxGetDevProductType", found.get_dev_product_type);
  symbols.find("DAQmxGetDevSerialNum", found.get_dev_serial_num);
  symbols.find("DAQmxResetDevice", found.reset_device);
  symbols.find("DAQmxSelfTestDevice", found.self_test_device);
  symbols.find("DAQmxCreateTask", found.create_task);
  symbols.find("DAQmxTaskControl", found.task_control);
  symbols.find("DAQmxStartTask", found.start_task);
  symbols.find("DAQmxStopTask", found.stop_task);
  symbols.find("DAQmxClearTask", found.clear_task);
  symbols.find("DAQmxCreateAIVoltageChan", found.create_ai_voltage_chan);
  symbols.find("DAQmxCreateAOVoltageChan", found.create_ao_voltage_chan);
  symbols.find("DAQmxCreateDIChan", found.create_di_chan);
  symbols.find("DAQmxCreateDOChan", found.create_do_chan);
  symbols.find("DAQmxReadAnalogF64", found.read_analog_f64);
  symbols.find("DAQmxReadDigitalScalarU32", found.read_digital_scalar_u32);
  symbols.find("DAQmxWriteAnalogScalarF64", found.write_analog_scalar_f64);
  symbols.find("DAQmxWriteDigitalScalarU32", found.write_digital_scalar_u32);
  if (!symbols.missing().empty())
    throw ConfigError(fmt::format("the NI-DAQmx driver lacks {}", fmt::join(symbols.missing(), ", ")),
                      library, kInstall);
  return found;
}

}  // namespace biopsy::nidaqmx
