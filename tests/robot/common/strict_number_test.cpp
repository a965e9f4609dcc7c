#include "robot/common/text/strict_number.hpp"

#include <gtest/gtest.h>

namespace biopsy {
namespace {

TEST(StrictNumber, TakesAllOfTheTextOrNothing) {
  EXPECT_EQ(strict_number(" -1.5e-3 "), -1.5e-3);
  EXPECT_EQ(strict_number("+2"), 2.0);
  EXPECT_EQ(strict_integer(" 17 "), 17);
  for (const char* bad : {"", " ", "0,5", "1.5mm", "nan", "inf", "1e999", "--1", "+-1", "0x10", "1 2"})
    EXPECT_FALSE(strict_number(bad)) << bad;
  for (const char* bad : {"1.0", "99999999999999999999", ""}) EXPECT_FALSE(strict_integer(bad)) << bad;
}

TEST(StrictNumber, TakesListsWithoutHoles) {
  EXPECT_EQ(strict_numbers("0.5\\ 2 ", '\\'), (std::vector<double>{0.5, 2}));
  EXPECT_EQ(strict_numbers("4   5\t6", ' ').has_value(), false);  // a tab does not separate
  EXPECT_EQ(strict_numbers(" 4   5 6 ", ' '), (std::vector<double>{4, 5, 6}));
  for (const char* bad : {"1\\", "\\1", "1\\\\2", "1\\x"}) EXPECT_FALSE(strict_numbers(bad, '\\')) << bad;
}

}  // namespace
}  // namespace biopsy
