// Who may read and write the files of an installed robot, in which each process has a user of its own: a
// process that was taken over can neither use the keys of another nor drive its digital I/O.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robot/live/live_settings.hpp"

namespace biopsy::robot {

inline constexpr std::string_view kReadersGroup = "biopsy";   // every process: settings, planning images
inline constexpr std::string_view kIoGroup = "biopsy-lines";  // those that read the digital I/O

struct Ownership {
  std::filesystem::path path;
  std::string user, group;
  mode_t mode = 0;
};

// Of everything in the run folder, of the keys and of the digital I/O, folders before what they hold. Keys
// belong to their process, those of nobody's process to root. The panel's levels belong to the stage's
// process, which reads them from its board; on a simulated stage to the console's, whose page turns the
// simulated keys.
std::vector<Ownership> ownership_of(const std::filesystem::path& run_folder,
                                    const live::LiveSettings& settings);

// Sets owners and modes; never follows a symbolic link. Throws ConfigError: not permitted, a user or group
// that does not exist, a file that is a link.
void give_to_owners(const std::vector<Ownership>& files);

}  // namespace biopsy::robot
