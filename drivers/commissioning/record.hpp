// What was measured when a laboratory took its stage into service. Values, and their one form as a file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::commissioning {

// One measured number and what it was held to. NaN: could not be measured, and is not within anything.
struct Figure {
  std::string what, unit;
  double value = 0.0, low = 0.0, high = 0.0;
  std::string why;  // of the limits

  bool ok() const { return value >= low && value <= high; }
};

struct StepRecord {
  std::string name;
  std::vector<Figure> figures;
  std::string note;  // what happened besides; empty: nothing

  bool passed() const;  // every figure was measured and is within its limits
};

struct Device {
  std::string kind;     // "sim", "nidaqmx"
  std::string product;  // "USB-6211"
  std::uint32_t serial = 0;

  bool operator==(const Device&) const = default;
};

struct Record {
  Device device;
  std::string config_sha256;  // of the configuration file's bytes, 64 hexadecimal digits
  std::string software;       // version of the program
  std::int64_t made_unix_s = 0;
  std::vector<StepRecord> steps;  // in the order done; ends with the first that did not pass

  bool passed() const;  // every step of this program's list was done and passed
};

// Whole text of commissioning.json. The date also stands there in words; made_unix_s is what counts.
std::string to_json(const Record& record);

// Throws ConfigError, naming `place`, for a text that is no such record.
Record from_json(std::string_view text, const std::string& place);

}  // namespace biopsy::commissioning
