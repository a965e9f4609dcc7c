#include "drivers/nidaqmx/config.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(device_config) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  reads_or_refuses([&] {
    const nidaqmx::Config read = nidaqmx::parse_config(text_of(bytes), "device.toml");
    claim(read.command.highest_kV > 0.0 && read.command.highest_kV <= 8.0, "never above 8 kV");
    claim(read.command.kV_per_V > 0.0, "a gain that is one");
  });
}
