// What a status code of NI-DAQmx means for a needle.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/nidaqmx/daqmx_functions.hpp"

namespace biopsy::nidaqmx {

enum class Trouble : std::uint8_t {
  None,     // warnings included
  Stale,    // nothing came in time: the reading is not renewed
  Overrun,  // samples were lost: the reading is not renewed
  Refused,  // bad channel or device, or in use elsewhere: a matter of set-up
  Gone,     // unplugged or reset: the stage stops and stays stopped
  Fault,    // anything else, an invalid task among it: likewise
};

Trouble trouble_of(Status status);
std::string_view name_of(Trouble trouble);

// Newest error with the driver's own words, taken at once because the next call overwrites them. Of fixed
// size: it is filled within the tick.
struct TroubleNote {
  Trouble trouble = Trouble::None;
  Status status = 0;
  std::uint32_t count = 0;  // errors so far
  std::array<char, 2048> text{};
};

// Set-up only: throws ConfigError, with the driver's own words, where `status` is an error.
void demand(const DaqmxFunctions& daqmx, Status status, const std::string& where);

}  // namespace biopsy::nidaqmx
