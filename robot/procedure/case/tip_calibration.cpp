#include "robot/procedure/case/tip_calibration.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "robot/security/key_files.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRemedy = "calibrate the needle in this sequence: biopsy calibrate-tip";
// Between insertions of one needle in one gel: its angle to the field, its place in the slice.
constexpr double kScatterOfOne_mm = 0.3;

TipCalibration calibration_of(TomlTable& root) {
  TipCalibration calibration;
  TomlTable table = root.table("tip_offset");
  calibration.offset = {table.text("needle"), table.text("sequence"),
                        Millimetres(table.number("value_mm", -kOffsetMost_mm, kOffsetMost_mm, "mm")),
                        Millimetres(table.number("sigma_mm", 0.01, 5.0, "mm"))};
  for (TomlTable& one : root.tables("measurement"))
    calibration.measurements.push_back({one.number("offset_mm", -kOffsetMost_mm, kOffsetMost_mm, "mm"),
                                        one.number("sigma_mm", 0.01, 5.0, "mm"),
                                        one.has("source") ? one.text("source") : ""});
  return calibration;
}

void check_signature(const fs::path& file, const std::string& text, fs::path public_key) {
  const fs::path signature = signature_of(file);
  if (!fs::exists(signature)) throw ConfigError("the calibration is not signed", file.string(), kRemedy);
  if (public_key.empty())
    public_key =
        security::signing_files(security::default_folder(), security::Signer::Commissioning).public_key;
  if (!is_signed_by(read_public_key(public_key), read_file(signature, kRemedy), text))
    throw ConfigError("the calibration was changed after it was signed, or signed with another key",
                      file.string(), kRemedy);
}

}  // namespace

TipOffset tip_offset_of(const std::string& needle, const std::string& sequence,
                        const std::vector<TipMeasurement>& measurements) {
  double weights = 0.0, sum = 0.0;
  for (const TipMeasurement& one : measurements) {
    const double weight = 1.0 / (one.sigma_mm * one.sigma_mm);
    weights += weight, sum += weight * one.offset_mm;
  }
  const double value = sum / weights;
  double scatter = kScatterOfOne_mm * kScatterOfOne_mm;  // variance
  if (measurements.size() > 1) {
    double squares = 0.0, expected = 0.0;
    for (const TipMeasurement& one : measurements)
      squares += std::pow(one.offset_mm - value, 2), expected += one.sigma_mm * one.sigma_mm;
    const auto n = static_cast<double>(measurements.size());
    const double seen = std::max(squares / (n - 1.0) - expected / n, 0.0);
    scatter = (scatter + (n - 1.0) * seen) / n;  // the assumption counts as one insertion
  }
  const double sigma =
      std::sqrt(1.0 / weights + scatter * (1.0 + 1.0 / static_cast<double>(measurements.size())));
  return {needle, sequence, Millimetres(value), Millimetres(sigma)};
}

std::string tip_calibration_toml(const TipCalibration& calibration) {
  const TipOffset& offset = calibration.offset;
  std::string text = fmt::format(
      "[tip_offset]\nneedle = {}\nsequence = {}\nvalue_mm = {:.3f}  # the void ends this far beyond the tip\n"
      "sigma_mm = {:.3f}  # of the next insertion\n",
      quoted(offset.needle), quoted(offset.sequence), offset.value.value, offset.sigma.value);
  for (const TipMeasurement& one : calibration.measurements)
    text += fmt::format("\n[[measurement]]\noffset_mm = {:.3f}\nsigma_mm = {:.3f}\nsource = {}\n",
                        one.offset_mm, one.sigma_mm, quoted(one.source));
  return text;
}

TipCalibration read_tip_calibration(const fs::path& file, const fs::path& public_key) {
  const std::string text = read_file(file, kRemedy);
  TipCalibration calibration =
      parse_toml(text, file.string(), [](TomlTable& root) { return calibration_of(root); });
  if (calibration.offset.sequence != kSimulatedSequence) check_signature(file, text, public_key);
  return calibration;
}

fs::path signature_of(const fs::path& file) {
  return fs::path(file).replace_extension(".sig");
}

}  // namespace biopsy::robot
