#include "drivers/nidaqmx/trouble.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"

namespace biopsy::nidaqmx {
namespace {

const char* remedy_for(Trouble trouble) {
  switch (trouble) {
    case Trouble::Refused:
      return "check device and channel names against `nilsdev`, and close every other program that uses the "
             "board";
    case Trouble::Gone:
      return "plug the board in, wait until `nilsdev` lists it, and start again";
    case Trouble::None:
    case Trouble::Stale:
    case Trouble::Overrun:
    case Trouble::Fault:
      break;
  }
  return "unplug the board, plug it in again, and start again; if it stays, test the board with NI's own "
         "tools";
}

}  // namespace

Trouble trouble_of(Status status) {
  if (status >= 0) return Trouble::None;
  switch (status) {
    case -200284:  // timeout before all samples were there
      return Trouble::Stale;
    case -200279:  // samples are no longer available
    case -200278:  // sample is not available yet at that position
      return Trouble::Overrun;
    case -200077:  // value not supported
    case -200170:  // no such channel
    case -200220:  // no such device
    case -50103:   // resource reserved
    case -200022:  // resource reserved by another task
      return Trouble::Refused;
    case -201003:  // device cannot be accessed
    case -200324:  // device was removed
    case -50405:   // transfer aborted, device removed
    case -50400:   // transfer aborted
      return Trouble::Gone;
    default:  // -200088, invalid task, is one of many
      return Trouble::Fault;
  }
}

std::string_view name_of(Trouble trouble) {
  switch (trouble) {
    case Trouble::None:
      return "none";
    case Trouble::Stale:
      return "timeout";
    case Trouble::Overrun:
      return "samples lost";
    case Trouble::Refused:
      return "bad or busy channel or device";
    case Trouble::Gone:
      return "device gone";
    case Trouble::Fault:
      return "fault";
  }
  return "unknown trouble";
}

void demand(const DaqmxFunctions& daqmx, Status status, const std::string& where) {
  if (status >= 0) return;
  TroubleNote words;
  daqmx.get_extended_error_info(words.text.data(), static_cast<std::uint32_t>(words.text.size()) - 1);
  const Trouble trouble = trouble_of(status);
  throw ConfigError(fmt::format("NI-DAQmx {} ({}): {}", status, name_of(trouble), words.text.data()), where,
                    remedy_for(trouble));
}

}  // namespace biopsy::nidaqmx
