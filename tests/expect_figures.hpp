// A test whose figures are the same each time claims those that were kept for the documentation.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "tests/kept_figures.hpp"

namespace biopsy {

// Keeps them anew where BIOPSY_KEEP_FIGURES is set. Another version of what they depend on may give others:
// then nothing is claimed, and the test says so.
inline void expect_figures(const std::string& name, const KeptFigures& measured) {
  if (std::getenv("BIOPSY_KEEP_FIGURES") != nullptr) return write_figures(name, measured);
  const KeptFigures kept = read_figures(name);
  if (kept.with != measured.with) {
    std::cout << name << ": kept with " << kept.with << ", not compared with those of " << measured.with
              << '\n';
    return;
  }
  EXPECT_EQ(kept.rows, measured.rows) << name << ": BIOPSY_KEEP_FIGURES=1 keeps them anew";
}

}  // namespace biopsy
