#include "robot/common/operator_name.hpp"

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cstdlib>

namespace biopsy {

std::string operator_name() {
  std::string name;
  if (const char* given = std::getenv("BIOPSY_OPERATOR")) name = given;
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  if (name.empty() && getpwuid_r(getuid(), &entry, buffer.data(), buffer.size(), &found) == 0 &&
      found != nullptr)
    name = found->pw_name;
  name = name.substr(0, 100);
  for (char& letter : name)
    if (std::iscntrl(static_cast<unsigned char>(letter)) != 0) letter = ' ';
  return name.empty() ? "unknown" : name;
}

}  // namespace biopsy
