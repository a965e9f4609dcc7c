#include "drivers/commissioning/load_commissioning.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::commissioning {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRemedy = "commission the stage: biopsy commission (docs/how-to/commission-a-stage.md)";
constexpr std::chrono::hours kClockTolerance{1};

std::string to_text(const Device& device) {
  return fmt::format("{} {} {}", device.kind, device.product, device.serial);
}

}  // namespace

Record load_commissioning(const fs::path& folder, const fs::path& public_key, const Device& device,
                          const std::string& config_sha256, std::chrono::system_clock::time_point now) {
  const fs::path file = folder / kRecordFile;
  const std::string place = file.string();
  if (!fs::exists(file) || !fs::exists(folder / kSignatureFile))
    throw ConfigError("the stage has no record of commissioning", place, kRemedy);
  const std::string text = read_file(file, kRemedy);
  if (!is_signed_by(read_public_key(public_key), read_file(folder / kSignatureFile, kRemedy), text))
    throw ConfigError("the record was changed after it was signed, or signed with another key", place,
                      kRemedy);
  Record record = from_json(text, place);
  if (record.device != device)
    throw ConfigError(
        fmt::format("is the record of {}; connected is {}", to_text(record.device), to_text(device)), place,
        kRemedy);
  if (record.config_sha256 != config_sha256)
    throw ConfigError("the configuration was changed after commissioning", place, kRemedy);
  if (!record.passed()) throw ConfigError("the stage did not pass all steps of this version", place, kRemedy);
  const std::chrono::sys_seconds made{std::chrono::seconds(record.made_unix_s)};
  if (made > now + kClockTolerance)
    throw ConfigError("the record is dated in the future", place,
                      "set this computer's clock, or commission anew");
  if (now > made + kGoodFor)
    throw ConfigError(fmt::format("the record is older than {} days", kGoodFor.count()), place, kRemedy);
  return record;
}

}  // namespace biopsy::commissioning
