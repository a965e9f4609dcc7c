// A driver of which nearly everything is missing.
#include <cstdint>

extern "C" std::int32_t DAQmxGetSysDevNames(char*, std::uint32_t) {
  return 0;
}
