// A network that loses, repeats and holds back packets, for processes that are started while it lives.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace biopsy::live_tests {

// Packets that the processes send: of a thousand, or so far.
struct PacketTrouble {
  std::uint32_t lost = 0, doubled = 0;
  std::uint32_t late = 0;  // go out behind the next one
};

class BadWire {
 public:
  explicit BadWire(const std::filesystem::path& folder) : file_(folder / "lossy") {
    std::ofstream(file_, std::ios::binary) << std::string(6 * sizeof(std::uint32_t), '\0');
    setenv("LOSSY_FILE", file_.c_str(), 1);
    setenv("LD_PRELOAD", (LOSSY + (before_.empty() ? "" : ":" + before_)).c_str(), 1);
  }
  ~BadWire() {
    setenv("LD_PRELOAD", before_.c_str(), 1);
    unsetenv("LOSSY_FILE");
  }
  BadWire(const BadWire&) = delete;
  BadWire& operator=(const BadWire&) = delete;

  void set(const PacketTrouble& trouble) {  // in place: it is mapped
    const std::array<std::uint32_t, 3> per_mille{trouble.lost, trouble.doubled, trouble.late};
    std::fstream out(file_, std::ios::binary | std::ios::in | std::ios::out);
    out.write(reinterpret_cast<const char*>(per_mille.data()), sizeof per_mille);
  }

  // What really happened to packets: without it a claim about a bad wire could be one about a good one.
  PacketTrouble done() const {
    std::array<std::uint32_t, 6> all{};
    std::ifstream(file_, std::ios::binary).read(reinterpret_cast<char*>(all.data()), sizeof all);
    return {all[3], all[4], all[5]};
  }

 private:
  static std::string loaded_before() {
    const char* text = std::getenv("LD_PRELOAD");
    return text == nullptr ? std::string() : text;
  }

  std::filesystem::path file_;
  const std::string before_ = loaded_before();  // a slowed clock's
};

}  // namespace biopsy::live_tests
