// The commissioning record: what was measured when the stage was taken into service, and its JSON form.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace biopsy::commissioning {

// A measured value and its limits. NaN: could not be measured; within no limits.
struct Figure {
  std::string what, unit;
  double value = 0.0, low = 0.0, high = 0.0;
  std::string why;  // of the limits

  bool ok() const { return value >= low && value <= high; }
};

struct StepRecord {
  std::string name;
  std::vector<Figure> figures;
  std::string note;  // remarks; may be empty

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
  std::vector<StepRecord> steps;  // in order; the last may not have passed

  bool passed() const;  // all_steps() were carried out and passed
};

// Content of commissioning.json. Its "date" is for readers; made_unix_s counts.
std::string to_json(const Record& record);

// Throws ConfigError, naming `place`, for a text that is no such record.
Record from_json(std::string_view text, const std::string& place);

}  // namespace biopsy::commissioning
