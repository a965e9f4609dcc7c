// Properties: claims over values that nobody thought of, made by rapidcheck and made small when one breaks.
// Always the same values: the seed is fixed. RC_PARAMS="seed=... max_success=..." looks at others.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace biopsy::properties {

inline const bool kSeeded = setenv("RC_PARAMS", "seed=20261121 max_success=500", 0) == 0;

// Enough bytes to fill any of our messages with anything at all.
inline std::vector<std::uint8_t> any_bytes(std::size_t count = 1'000) {
  return *rc::gen::container<std::vector<std::uint8_t>>(count, rc::gen::arbitrary<std::uint8_t>());
}

// Text as people of any language type it, control characters included; never the end of a C string.
inline std::string any_text() {
  static const std::vector<std::string> kPieces{"a",
                                                "Z",
                                                "7",
                                                " ",
                                                "\"",
                                                "\\",
                                                "'",
                                                "\n",
                                                "\r",
                                                "\t",
                                                "#",
                                                ",",
                                                "=",
                                                "]",
                                                "\x01",
                                                "\x7f",
                                                "\xc3\xa9",
                                                "\xe6\x88\x91",
                                                "\xf0\x9f\x92\x89"};
  std::string text;
  for (const auto piece :
       *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, kPieces.size())))
    text += kPieces[piece];
  return text;
}

// From `low` to `high`, as often at the ends as anywhere else.
inline double any_number(double low, double high) {
  const int parts = *rc::gen::element(0, 1, 1'000'000, *rc::gen::inRange(0, 1'000'001));
  return std::lerp(low, high, parts / 1e6);
}

}  // namespace biopsy::properties
