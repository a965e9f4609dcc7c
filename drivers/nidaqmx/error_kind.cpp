#include "drivers/nidaqmx/error_kind.hpp"

#include <fmt/format.h>

#include <array>

#include "robot/common/config_error.hpp"

namespace biopsy::nidaqmx {
namespace {

struct Text {
  const char *name, *remedy;
};

Text text_of(ErrorKind kind) {
  constexpr const char* kReplug =
      "unplug the board, plug it in again, and start again; if it stays, test the board with NI's own tools";
  switch (kind) {
    case ErrorKind::Stale:
      return {"timeout", kReplug};
    case ErrorKind::Overrun:
      return {"samples lost", kReplug};
    case ErrorKind::Refused:
      return {"bad or busy channel or device",
              "check device and channel names against `nilsdev`, and close every other program that uses the "
              "board"};
    case ErrorKind::Gone:
      return {"device gone", "plug the board in, wait until `nilsdev` lists it, and start again"};
    case ErrorKind::None:
    case ErrorKind::Fault:
      break;
  }
  return {"fault", kReplug};
}

}  // namespace

ErrorKind error_kind(Status status) {
  if (status >= 0) return ErrorKind::None;
  switch (status) {
    case -200284:  // timeout before all samples were there
      return ErrorKind::Stale;
    case -200279:  // samples are no longer available
    case -200278:  // sample is not available yet at that position
      return ErrorKind::Overrun;
    case -200077:  // value not supported
    case -200170:  // no such channel
    case -200220:  // no such device
    case -50103:   // resource reserved
    case -200022:  // resource reserved by another task
      return ErrorKind::Refused;
    case -201003:  // device cannot be accessed
    case -200324:  // device was removed
    case -50405:   // transfer aborted, device removed
    case -50400:   // transfer aborted
      return ErrorKind::Gone;
    default:  // -200088, invalid task, is one of many
      return ErrorKind::Fault;
  }
}

void require_success(const DaqmxFunctions& daqmx, Status status, const std::string& where) {
  if (status >= 0) return;
  std::array<char, 2048> driver_text{};
  daqmx.get_extended_error_info(driver_text.data(), static_cast<std::uint32_t>(driver_text.size()) - 1);
  const Text text = text_of(error_kind(status));
  throw ConfigError(fmt::format("NI-DAQmx {} ({}): {}", status, text.name, driver_text.data()), where,
                    text.remedy);
}

}  // namespace biopsy::nidaqmx
