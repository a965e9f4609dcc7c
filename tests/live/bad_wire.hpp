// A network that loses, repeats and holds back packets, for processes that are started while it lives.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace biopsy::live_tests {

// Of a thousand packets that the processes send.
struct PacketTrouble {
  std::uint32_t lost = 0, doubled = 0;
  std::uint32_t late = 0;  // go out behind the next one
};

class BadWire {
 public:
  explicit BadWire(const std::filesystem::path& folder) : file_(folder / "lossy") {
    set({});
    setenv("LOSSY_FILE", file_.c_str(), 1);
    setenv("LD_PRELOAD", LOSSY, 1);
  }
  ~BadWire() {
    unsetenv("LD_PRELOAD");
    unsetenv("LOSSY_FILE");
  }
  BadWire(const BadWire&) = delete;
  BadWire& operator=(const BadWire&) = delete;

  void set(const PacketTrouble& trouble) {  // in place: it is mapped
    const std::array<std::uint32_t, 3> per_mille{trouble.lost, trouble.doubled, trouble.late};
    std::fstream out(file_, std::ios::binary | std::ios::in | std::ios::out);
    if (!out) out.open(file_, std::ios::binary | std::ios::out);
    out.write(reinterpret_cast<const char*>(per_mille.data()), sizeof per_mille);
  }

 private:
  std::filesystem::path file_;
};

}  // namespace biopsy::live_tests
