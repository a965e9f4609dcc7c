#include "drivers/commissioning/load_commissioning.hpp"

#include <fmt/format.h>

#include "drivers/commissioning/signature.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAnew =
    "take the stage into service: biopsy commission (docs/how-to/commission-a-stage.md)";
// A record of tomorrow is a clock that was set wrong, now or then; an hour is a time zone's slip.
constexpr std::chrono::hours kAhead{1};

std::string words(const Device& device) {
  return fmt::format("{} {} {}", device.kind, device.product, device.serial);
}

}  // namespace

Record load_commissioning(const fs::path& folder, const fs::path& public_key, const Device& device,
                          const std::string& config_sha256, std::chrono::system_clock::time_point now) {
  const fs::path file = folder / kRecordFile;
  const std::string place = file.string();
  if (!fs::exists(file) || !fs::exists(folder / kSignatureFile))
    throw ConfigError("the stage has no record of commissioning", place, kAnew);
  const std::string text = read_file(file, kAnew);
  if (!is_signed(public_key, text, read_file(folder / kSignatureFile, kAnew)))
    throw ConfigError("the record was changed after it was signed, or signed with another key", place, kAnew);
  Record record = from_json(text, place);
  if (record.device != device)
    throw ConfigError(
        fmt::format("is the record of {}; connected is {}", words(record.device), words(device)), place,
        kAnew);
  if (record.config_sha256 != config_sha256)
    throw ConfigError("the configuration was changed after commissioning", place, kAnew);
  if (!record.passed()) throw ConfigError("the stage did not pass all steps of this version", place, kAnew);
  const std::chrono::sys_seconds made{std::chrono::seconds(record.made_unix_s)};
  if (made > now + kAhead)
    throw ConfigError("the record is of a day to come", place,
                      "set this computer's clock, or commission anew");
  if (now > made + kGoodFor)
    throw ConfigError(fmt::format("the record is older than {} days", kGoodFor.count()), place, kAnew);
  return record;
}

}  // namespace biopsy::commissioning
