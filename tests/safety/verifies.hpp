// A test says which requirements of the safety case it is evidence for: verifies("R-06"). The case reads it
// from the test's result, so that a name nobody ran proves nothing.
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace biopsy {

template <class... Names>
void verifies(const Names&... requirements) {
  std::string all;
  ((all += (all.empty() ? "" : ",") + std::string(requirements)), ...);
  testing::Test::RecordProperty("verifies", all);
}

}  // namespace biopsy
