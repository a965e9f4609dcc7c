#include "robot/common/text/encoding.hpp"

#include <gtest/gtest.h>

#include "robot/common/byte_writer.hpp"
#include "robot/common/sha256.hpp"

namespace biopsy {
namespace {

// RFC 4648, section 10.
TEST(Base64, MatchesTheVectorsOfRfc4648) {
  const std::pair<const char*, const char*> kVectors[] = {{"", ""},
                                                          {"f", "Zg=="},
                                                          {"fo", "Zm8="},
                                                          {"foo", "Zm9v"},
                                                          {"foob", "Zm9vYg=="},
                                                          {"fooba", "Zm9vYmE="},
                                                          {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : kVectors) EXPECT_EQ(base64(bytes), text);
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
}

// FIPS 180-2, appendix B.1, and the hash of nothing.
TEST(Sha256, MatchesTheVectorsOfTheStandard) {
  EXPECT_EQ(hex(sha256("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hex(sha256("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(first_64_bits(sha256("abc")), 0xba7816bf8f01cfeaU);
}

TEST(ByteWriter, WritesLittleEndianWithLengths) {
  ByteWriter to;
  to.byte(7).integer(0x0102).text("ab").number(-0.0);
  EXPECT_EQ(hex(to.bytes()),
            "07"
            "0201000000000000"
            "0200000000000000"
            "6162"
            "0000000000000000");
}

}  // namespace
}  // namespace biopsy
