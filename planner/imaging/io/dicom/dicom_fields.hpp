// Strict access to the elements of a DICOM data set: an element is absent, or what the standard says, or
// refused.
#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace biopsy::imaging {

// The element's text as it stands, several values joined with '\'; empty where absent. Control characters
// become '?'.
std::string dicom_text(DcmItem& item, const DcmTagKey& tag);

// Decimal numbers; nothing where the element is absent or empty. Throws ConfigError naming the file when
// there are not exactly `count` finite numbers.
std::optional<std::vector<double>> dicom_numbers(DcmItem& item, const DcmTagKey& tag, std::size_t count,
                                                 const std::string& file);
std::vector<double> required_dicom_numbers(DcmItem& item, const DcmTagKey& tag, std::size_t count,
                                           const std::string& file);

std::optional<int> dicom_unsigned_short(DcmItem& item, const DcmTagKey& tag);

// First item of a sequence, or nullptr.
DcmItem* dicom_first_item(DcmItem& item, const DcmTagKey& sequence);

std::string dicom_tag_name(const DcmTagKey& tag);

}  // namespace biopsy::imaging
