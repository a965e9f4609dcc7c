// One target a file: FUZZ(name) { ... bytes ... }. Under libFuzzer (preset fuzz) it is a program that looks
// for bytes that break a claim; in the ordinary tests the same function reads every file of corpus/name, so
// that what was found once stays mended.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::fuzz {

using Bytes = std::span<const std::uint8_t>;

// A claim that does not hold ends the program: that is what a fuzzer looks for.
inline void claim(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

// Reads, or refuses with a sentence and a remedy. Any other exception is a finding.
template <class Read>
void reads_or_refuses(Read&& read) {
  try {
    read();
  } catch (const ConfigError& refusal) {
    claim(!refusal.what_is_wrong.empty() && !refusal.where.empty() && !refusal.remedy.empty(),
          "a refusal says what is wrong, where, and what to do");
  }
}

inline std::string text_of(Bytes bytes) {
  return {bytes.begin(), bytes.end()};
}

// The bytes as a file of this name, in a folder that lasts as long as the program.
inline std::filesystem::path as_file(const std::string& name, Bytes bytes) {
  static const ScratchFolder folder;
  write_content(folder / name, text_of(bytes));
  return folder / name;
}

// Numbers out of bytes, zeros when they are used up.
class Feed {
 public:
  explicit Feed(Bytes bytes) : left_(bytes) {}
  bool empty() const { return left_.empty(); }

  template <class Number>
  Number any() {
    if constexpr (std::is_same_v<Number, bool>) {
      return (any<std::uint8_t>() & 1) != 0;
    } else if constexpr (std::is_enum_v<Number>) {
      return static_cast<Number>(any<std::underlying_type_t<Number>>());
    } else {
      Number value{};
      const std::size_t size = std::min(sizeof(value), left_.size());
      if (size > 0) std::memcpy(&value, left_.data(), size);
      left_ = left_.subspan(size);
      return value;
    }
  }
  template <class... Numbers>
  void fill(Numbers&... numbers) {
    ((numbers = any<Numbers>()), ...);
  }

 private:
  Bytes left_;
};

}  // namespace biopsy::fuzz

#ifdef BIOPSY_FUZZ
#define FUZZ(name)                                                                    \
  static void fuzz_##name(biopsy::fuzz::Bytes bytes);                                 \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    fuzz_##name({data, size});                                                        \
    return 0;                                                                         \
  }                                                                                   \
  static void fuzz_##name(biopsy::fuzz::Bytes bytes)
#else
#include <gtest/gtest.h>

namespace biopsy::fuzz {

inline void replay(const std::string& name, void (*target)(Bytes)) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(biopsy::source_dir() / "tests/verification/fuzz/corpus/" / name)) {
    SCOPED_TRACE(entry.path().string());
    const std::string content = file_content(entry.path());
    target({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()});
    ++files;
  }
  EXPECT_GT(files, 0) << "a target without a corpus is not replayed";
}

}  // namespace biopsy::fuzz

#define FUZZ(name)                                    \
  static void fuzz_##name(biopsy::fuzz::Bytes bytes); \
  TEST(Corpus, name) {                                \
    biopsy::fuzz::replay(#name, fuzz_##name);         \
  }                                                   \
  static void fuzz_##name(biopsy::fuzz::Bytes bytes)
#endif
