// One NI-DAQmx task, stopped and cleared at its end.
#pragma once

#include <string>

#include "drivers/nidaqmx/trouble.hpp"

namespace biopsy::nidaqmx {

class Task {
 public:
  // Throws ConfigError. `daqmx` must outlive this.
  Task(const DaqmxFunctions& daqmx, const std::string& name) : daqmx_(daqmx) {
    demand(daqmx, daqmx.create_task(name.c_str(), &handle_), "task " + name);
  }
  ~Task() {  // errors cannot be answered any more
    daqmx_.stop_task(handle_);
    daqmx_.clear_task(handle_);
  }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  TaskHandle handle() const { return handle_; }

  // Takes the resources, so that a board in use elsewhere is refused here and not in the first tick.
  void start(const std::string& where) {
    demand(daqmx_, daqmx_.task_control(handle_, kTaskCommit), where);
    demand(daqmx_, daqmx_.start_task(handle_), where);
  }

 private:
  const DaqmxFunctions& daqmx_;
  TaskHandle handle_ = nullptr;
};

}  // namespace biopsy::nidaqmx
