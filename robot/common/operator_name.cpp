#include "robot/common/operator_name.hpp"

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "robot/common/text/sanitize_text.hpp"

namespace biopsy {
namespace {

constexpr std::size_t kMost = 100;  // bytes

}  // namespace

std::string operator_name() {
  std::string name;
  if (const char* given = std::getenv("BIOPSY_OPERATOR")) name = given;
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  if (name.empty() && getpwuid_r(getuid(), &entry, buffer.data(), buffer.size(), &found) == 0 &&
      found != nullptr)
    name = found->pw_name;
  name = plain(name);
  if (name.size() > kMost) {
    std::size_t end = kMost;
    while ((static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;  // not inside a character
    name.resize(end);
  }
  return name.empty() ? "unknown" : name;
}

}  // namespace biopsy
