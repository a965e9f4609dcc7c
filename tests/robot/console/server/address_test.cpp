// The address of the page, read again by a console that is started again; and compression of what is sent.
#include <gtest/gtest.h>

#include "robot/console/server/gzip.hpp"
#include "robot/console/server/origin_policy.hpp"

namespace biopsy::console {
namespace {

TEST(Address, GivesPortAndToken) {
  const std::string token = new_token();
  const auto address = address_of("http://127.0.0.1:40123/?t=" + token + "\n");
  ASSERT_TRUE(address.has_value());
  EXPECT_EQ(address->port, 40123);
  EXPECT_EQ(address->token, token);
}

TEST(Address, OfAnythingElseIsNone) {
  const std::string token = new_token();
  for (const std::string& text :
       {std::string(), std::string("http://127.0.0.1:"), "http://127.0.0.1:70000/?t=" + token,
        "http://example.org:80/?t=" + token, "http://127.0.0.1:80/?t=" + token.substr(1),
        "http://127.0.0.1:80/?t=" + std::string(32, 'G'), "http://127.0.0.1:80/page?t=" + token})
    EXPECT_FALSE(address_of(text).has_value()) << text;
}

TEST(Gzip, MakesAGzipFileThatIsSmaller) {
  const std::string compressed = gzip(std::string(100'000, 'a'));
  EXPECT_LT(compressed.size(), 1'000);
  EXPECT_EQ(compressed.substr(0, 3), "\x1f\x8b\x08");  // RFC 1952: magic, deflate
  EXPECT_GT(gzip("").size(), 17);                      // header and trailer of 18 bytes
}

}  // namespace
}  // namespace biopsy::console
