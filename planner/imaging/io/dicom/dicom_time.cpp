#include "planner/imaging/io/dicom/dicom_time.hpp"

#include <array>
#include <cmath>
#include <ctime>

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

// `count` digits of `text` from `at`, or nothing.
std::optional<int> digits(const std::string& text, std::size_t at, std::size_t count) {
  if (text.size() < at + count) return std::nullopt;
  int value = 0;
  for (std::size_t n = at; n < at + count; ++n) {
    if (text[n] < '0' || text[n] > '9') return std::nullopt;
    value = 10 * value + (text[n] - '0');
  }
  return value;
}

std::optional<int> zone_minutes(const std::string& zone) {
  const auto hours = digits(zone, 1, 2), minutes = digits(zone, 3, 2);
  if (zone.size() != 5 || !hours || !minutes || *hours > 14 || *minutes > 59) return std::nullopt;
  if (zone[0] != '+' && zone[0] != '-') return std::nullopt;
  return (zone[0] == '-' ? -1 : 1) * (60 * *hours + *minutes);
}

}  // namespace

std::optional<std::chrono::system_clock::time_point> time_of_dicom_texts(const std::string& date,
                                                                         const std::string& time,
                                                                         const std::string& zone) {
  const auto year = digits(date, 0, 4), month = digits(date, 4, 2), day = digits(date, 6, 2);
  const auto hour = digits(time, 0, 2), minute = digits(time, 2, 2), second = digits(time, 4, 2);
  if (date.size() != 8 || !year || !month || !day || !hour || !minute || !second) return std::nullopt;
  const std::chrono::year_month_day calendar{std::chrono::year(*year),
                                             std::chrono::month(static_cast<unsigned>(*month)),
                                             std::chrono::day(static_cast<unsigned>(*day))};
  if (!calendar.ok() || *year < 1970 || *hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  double fraction = 0.0;
  if (time.size() > 6) {
    const auto decimals = strict_number("0" + time.substr(6));
    if (time[6] != '.' || time.size() > 13 || !decimals) return std::nullopt;
    fraction = *decimals;
  }
  std::tm parts{};
  parts.tm_year = *year - 1900, parts.tm_mon = *month - 1, parts.tm_mday = *day;
  parts.tm_hour = *hour, parts.tm_min = *minute, parts.tm_sec = *second, parts.tm_isdst = -1;
  std::time_t seconds = 0;
  if (zone.empty()) {
    seconds = std::mktime(&parts);
  } else {
    const auto minutes = zone_minutes(zone);
    if (!minutes) return std::nullopt;
    seconds = timegm(&parts) - 60 * *minutes;
  }
  return std::chrono::system_clock::from_time_t(seconds) +
         std::chrono::microseconds(std::llround(fraction * 1e6));
}

std::optional<std::chrono::system_clock::time_point> dicom_acquisition_time(DcmItem& dataset) {
  const std::string zone = dicom_text(dataset, DCM_TimezoneOffsetFromUTC);
  const std::string both = dicom_text(dataset, DCM_AcquisitionDateTime);  // YYYYMMDDHHMMSS.FFFFFF&ZZXX
  if (both.size() >= 14) {
    const std::size_t sign = both.find_first_of("+-");
    const std::string own = sign == std::string::npos ? zone : both.substr(sign);
    if (const auto found = time_of_dicom_texts(
            both.substr(0, 8), both.substr(8, sign == std::string::npos ? sign : sign - 8), own))
      return found;
  }
  const std::array<std::pair<DcmTagKey, DcmTagKey>, 3> kinds{{{DCM_AcquisitionDate, DCM_AcquisitionTime},
                                                              {DCM_ContentDate, DCM_ContentTime},
                                                              {DCM_SeriesDate, DCM_SeriesTime}}};
  for (const auto& [date, time] : kinds)
    if (const auto found = time_of_dicom_texts(dicom_text(dataset, date), dicom_text(dataset, time), zone))
      return found;
  return std::nullopt;
}

}  // namespace biopsy::imaging
