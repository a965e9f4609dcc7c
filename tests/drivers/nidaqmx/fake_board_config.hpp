// The driver's configuration for the fake board.
#pragma once

#include "drivers/nidaqmx/nidaqmx_stage.hpp"
#include "tests/drivers/nidaqmx/fake/fake_board.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::nidaqmx {

// As in the sample configuration, but for the driver's library.
inline Config laboratory() {
  Config config = read_config(source_dir() / "drivers/nidaqmx/usb6211.toml");
  config.library = FAKE_NIDAQMX;
  return config;
}

}  // namespace biopsy::nidaqmx
