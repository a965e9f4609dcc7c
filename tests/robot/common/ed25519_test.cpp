// Keys and signatures of procedure logs and commissioning records.
#include "robot/common/ed25519.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <random>

#include "robot/common/config_error.hpp"
#include "tests/key_files.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy {
namespace {

// RFC 8032, section 7.1, test 2.
TEST(Ed25519, SignsAsTheStandardDoes) {
  const ScratchFolder folder;
  folder.write("rfc.pem",
               "-----BEGIN PRIVATE KEY-----\n"
               "MC4CAQAwBQYDK2VwBCIEIEzNCJso/5banbbDRuwRTg9bijGfNaumJNqM9u1PuKb7\n"
               "-----END PRIVATE KEY-----\n");
  const SigningKey key(folder / "rfc.pem");
  EXPECT_EQ(fmt::format("{:02x}", fmt::join(key.public_key(), "")),
            "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c");
  EXPECT_EQ(fmt::format("{:02x}", fmt::join(key.sign("\x72"), "")),
            "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da"
            "085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00");
}

TEST(Ed25519, AcceptsTheSignatureOfThisKeyAndTextOnly) {
  const ScratchFolder folder;
  make_key_files(folder / "key.pem", folder / "key.pub.pem");
  make_key_files(folder / "other.pem");
  const PublicKey known = read_public_key(folder / "key.pub.pem");
  const std::string signature{view(SigningKey(folder / "key.pem").sign("text"))};
  EXPECT_TRUE(is_signed_by(known, signature, "text"));
  EXPECT_FALSE(is_signed_by(known, signature, "Text"));
  EXPECT_FALSE(is_signed_by(known, view(SigningKey(folder / "other.pem").sign("text")), "text"));
  for (const std::string& other :
       {std::string(), signature.substr(0, 63), signature + "x", signature + signature})
    EXPECT_FALSE(is_signed_by(known, other, "text")) << other.size();
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    std::string changed = signature;
    changed[random() % changed.size()] ^= static_cast<char>(1U << random() % 8);
    EXPECT_FALSE(is_signed_by(known, changed, "text"));
  }
}

TEST(Ed25519, RefusesFilesThatHoldNoSuchKey) {
  const ScratchFolder folder;
  make_key_files(folder / "key.pem", folder / "key.pub.pem");
  make_key_files(folder / "odd.pem", folder / "odd.pub.pem", "X25519");
  folder.write("text.pem", "no key");
  for (const char* file : {"absent.pem", "text.pem", "odd.pem", "key.pub.pem"})
    EXPECT_THROW(SigningKey(folder / file), ConfigError) << file;
  for (const char* file : {"absent.pem", "text.pem", "odd.pub.pem", "key.pem"})
    EXPECT_THROW(read_public_key(folder / file), ConfigError) << file;
}

TEST(Ed25519, WritesThePublicKeyThatItReads) {
  const ScratchFolder folder;
  make_key_files(folder / "key.pem", folder / "key.pub.pem");
  EXPECT_EQ(pem_of(SigningKey(folder / "key.pem").public_key()), file_content(folder / "key.pub.pem"));
}

}  // namespace
}  // namespace biopsy
