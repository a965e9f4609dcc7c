// A record as a line of CSV (RFC 4180), with every field that is hashed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "robot/recorder/record.hpp"

namespace biopsy::recorder {

inline constexpr std::string_view kCsvHeader = "record,utc,utc_ns,mono_us,source,kind,body,previous,hash\r\n";

// Hashes in hexadecimal; texts in quotes, byte by byte.
std::string csv_line(const Record& record);

// "2026-11-21 18:10:23.123456789".
std::string utc_text(std::int64_t utc_ns);

}  // namespace biopsy::recorder
