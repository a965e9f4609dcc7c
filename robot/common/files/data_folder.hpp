// Where models, built-in cases, examples, the console's page and the safety case's tables are. But for the
// page their paths are those of the source tree.
#pragma once

#include <filesystem>

namespace biopsy {

// $BIOPSY_DATA where set; else share/biopsy beside the folder of the running program (an installation,
// wherever it was moved); else the source tree of the build tree that the program is in. Throws ConfigError
// naming those that were looked at where none is there.
std::filesystem::path data_folder();

// The built page of the console: console/page in data_folder(), else console/page/dist beside the program, as
// in a build tree. Throws ConfigError naming both where it is in neither.
std::filesystem::path page_folder();

// The source tree of a program in its build tree (its file source_folder.txt says where). Throws ConfigError
// for an installed one.
std::filesystem::path source_folder();

}  // namespace biopsy
