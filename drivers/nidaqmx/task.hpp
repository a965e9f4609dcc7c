// One NI-DAQmx task, stopped and cleared at its end.
#pragma once

#include <string>

#include "drivers/nidaqmx/error_kind.hpp"

namespace biopsy::nidaqmx {

class Task {
 public:
  // Throws ConfigError. `daqmx` must outlive this.
  Task(const DaqmxFunctions& daqmx, const std::string& name) : daqmx_(daqmx) {
    require_success(daqmx, daqmx.create_task(name.c_str(), &handle_), "task " + name);
  }
  ~Task() {  // errors are ignored: nothing follows
    daqmx_.stop_task(handle_);
    daqmx_.clear_task(handle_);
  }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  TaskHandle handle() const { return handle_; }

  // Reserves the board: one in use elsewhere is refused here, not in the first tick.
  void start(const std::string& where) {
    require_success(daqmx_, daqmx_.task_control(handle_, kTaskCommit), where);
    require_success(daqmx_, daqmx_.start_task(handle_), where);
  }

 private:
  const DaqmxFunctions& daqmx_;
  TaskHandle handle_ = nullptr;
};

}  // namespace biopsy::nidaqmx
