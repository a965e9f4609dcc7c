// What a status code of NI-DAQmx means for the stage.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/nidaqmx/daqmx_functions.hpp"

namespace biopsy::nidaqmx {

enum class ErrorKind : std::uint8_t {
  None,     // warnings included
  Stale,    // timeout: the reading is not renewed
  Overrun,  // samples were lost: the reading is not renewed
  Refused,  // during set-up: bad channel or device, or in use elsewhere
  Gone,     // unplugged or reset: the stage stops for good
  Fault,    // anything else, an invalid task among it: the stage stops for good
};

ErrorKind error_kind(Status status);

// Set-up only: throws ConfigError with the driver's own text where `status` is an error.
void require_success(const DaqmxFunctions& daqmx, Status status, const std::string& where);

}  // namespace biopsy::nidaqmx
