// When a DICOM image was acquired.
#pragma once

#include <chrono>
#include <optional>
#include <string>

class DcmItem;

namespace biopsy::imaging {

// Acquisition date and time, else those of the content, else of the series; by the scanner's clock, in the
// zone that the file names (Timezone Offset From UTC) or else that of this machine. Nothing where a date or a
// time is absent or is none.
std::optional<std::chrono::system_clock::time_point> dicom_acquisition_time(DcmItem& dataset);

// The same of the texts of DA, TM and the zone's "+hhmm" (empty: this machine's).
std::optional<std::chrono::system_clock::time_point> time_of_dicom_texts(const std::string& date,
                                                                         const std::string& time,
                                                                         const std::string& zone);

}  // namespace biopsy::imaging
