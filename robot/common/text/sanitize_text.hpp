// Text that came from outside (patient names, paths, reasons), made safe to show.
#pragma once

#include <string>
#include <string_view>

namespace biopsy {

// Valid UTF-8 without control or text-direction characters: cannot move a terminal's cursor or reverse a
// line.
std::string plain(std::string_view text);

// The same with & < > " ' escaped: safe between tags and inside quoted attributes of HTML and SVG.
std::string escaped(std::string_view text);

// "Doe, Jane Maria" from DICOM's "Doe^Jane^Maria".
std::string person_name(std::string_view dicom_name);

}  // namespace biopsy
