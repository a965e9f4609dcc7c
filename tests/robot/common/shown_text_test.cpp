// Text from outside that people read: names and whatever a message carries. Inputs: the code points that
// Unicode's bidirectional algorithm and its default-ignorable list name, and bytes that are no UTF-8.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "robot/common/operator_name.hpp"
#include "robot/common/text/sanitize_text.hpp"

namespace biopsy {
namespace {

TEST(Plain, ShowsNothingThatMovesTurnsOrHides) {
  for (const char* hidden : {"\x1b",
                             "\x07",
                             "\x7f",
                             "\xC2\x85",
                             "\xD8\x9C",
                             "\xE2\x80\x8B",
                             "\xE2\x80\x8C",
                             "\xE2\x80\x8D",
                             "\xE2\x80\x8E",
                             "\xE2\x80\x8F",
                             "\xE2\x80\xA8",
                             "\xE2\x80\xAE",
                             "\xE2\x81\xA6",
                             "\xE2\x81\xA9",
                             "\xC2\xAD",
                             "\xCD\x8F",
                             "\xE2\x81\xA0",
                             "\xE2\x81\xA4",
                             "\xE3\x85\xA4",
                             "\xEF\xB8\x8F",
                             "\xEF\xBB\xBF",
                             "\xEF\xBE\xA0",
                             "\xF3\xA0\x80\x81",
                             "\xF3\xA0\x81\xBF",
                             "\xF0\x9D\x85\xB3"})
    EXPECT_EQ(plain(std::string("a") + hidden + "b"), "a b");
  for (const char* shown : {"M\xC3\xBCller", "\xE2\x80\x90", "\xE2\x80\x8A", "\xD8\x9B", "\xE5\xB1\xB1",
                            "\xC2\xAE", "\xF0\x9F\xA9\xBA"})
    EXPECT_EQ(plain(shown), shown);
  EXPECT_EQ(plain("M\xFCller"), "M\xEF\xBF\xBDller") << "Latin-1";
}

class OperatorName : public testing::Test {
 protected:
  ~OperatorName() override { unsetenv("BIOPSY_OPERATOR"); }
  static std::string of(const std::string& given) {
    setenv("BIOPSY_OPERATOR", given.c_str(), 1);
    return operator_name();
  }
};

TEST_F(OperatorName, IsUtf8OfAHundredBytesAtMostWhateverWasGiven) {
  EXPECT_EQ(of("Dr. M\xC3\xBCller"), "Dr. M\xC3\xBCller");
  EXPECT_EQ(of("Dr. M\xFCller"), "Dr. M\xEF\xBF\xBDller");
  EXPECT_EQ(of("a\nb"), "a b");
  EXPECT_EQ(of(std::string(100, 'x')), std::string(100, 'x'));
  EXPECT_EQ(of(std::string(101, 'x')), std::string(100, 'x'));
  EXPECT_EQ(of(std::string(99, 'x') + "\xC3\xBC"), std::string(99, 'x')) << "not inside a character";
  EXPECT_EQ(of(std::string(98, 'x') + "\xC3\xBC"), std::string(98, 'x') + "\xC3\xBC");
  EXPECT_NE(of(""), "") << "the login name";
}

}  // namespace
}  // namespace biopsy
