// Which documents count as signed by one certificate: what PKCS #7 would allow besides is refused.
#include "robot/security/signed_text.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "robot/security/certificates.hpp"
#include "tests/robot/security/test_key_set.hpp"

namespace biopsy::security {
namespace {

const std::string kText = "<dds>\n<grant/>\n</dds>\n";

struct SignedText : testing::Test {
  // A certificate that the CA issued, which PKCS #7 trusts as it does the CA.
  Certificate issued(EVP_PKEY* to) const {
    return new_identity(Role::Planner, to, ca.get(), ca_key.get(), times);
  }
  // Several signers, or the text within the signature, by OpenSSL's own calls.
  std::string document(int flags, X509* second, EVP_PKEY* second_key) const {
    const Bio content = reader(kText), out = writer();
    const SignedDocument made(PKCS7_sign(ca.get(), ca_key.get(), nullptr, content.get(), flags));
    EXPECT_NE(made, nullptr);
    if (second != nullptr) {
      EXPECT_NE(PKCS7_sign_add_signer(made.get(), second, second_key, EVP_sha256(), 0), nullptr);
      EXPECT_EQ(PKCS7_final(made.get(), content.get(), flags), 1);
    }
    EXPECT_EQ(BIO_reset(content.get()), 1);
    BIO* beside = (flags & PKCS7_DETACHED) != 0 ? content.get() : nullptr;
    EXPECT_EQ(SMIME_write_PKCS7(out.get(), made.get(), beside, flags & ~PKCS7_PARTIAL), 1);
    return written(out);
  }

  const Validity times{now() - std::chrono::hours(1), now() + std::chrono::hours(1)};
  const Key ca_key = new_p256_key();
  const Certificate ca = new_ca("permissions CA", ca_key.get(), CaPurpose::SignsDocuments, times);
};

TEST_F(SignedText, IsReadAsItWasWritten) {
  EXPECT_EQ(verify_text(sign_text(kText, ca.get(), ca_key.get()), ca.get()), kText);
  EXPECT_EQ(verify_text(document(PKCS7_TEXT | PKCS7_DETACHED, nullptr, nullptr), ca.get()), kText);
}

TEST_F(SignedText, IsNoDocumentThatIsEmptyOrCut) {
  const std::string good = sign_text(kText, ca.get(), ca_key.get());
  for (const std::string& bad : {std::string(), std::string("x"), good.substr(0, good.size() / 2)})
    EXPECT_EQ(verify_text(bad, ca.get()), std::nullopt);
}

TEST_F(SignedText, IsNotOneWithAnotherLetter) {
  std::string altered = sign_text(kText, ca.get(), ca_key.get());
  altered.replace(altered.find("grant"), 5, "Grant");
  EXPECT_EQ(verify_text(altered, ca.get()), std::nullopt);
}

// A mistake in the program, not in a file.
TEST_F(SignedText, WithoutACertificateToTrustTheProgramEnds) {
  const std::string good = sign_text(kText, ca.get(), ca_key.get());
  EXPECT_EQ(verify_text(good, ca.get()), kText);
  EXPECT_DEATH((void)verify_text(good, nullptr), "trust a certificate");
}

TEST_F(SignedText, IsNotOneThatStandsWithinItsSignature) {
  EXPECT_EQ(verify_text(document(PKCS7_TEXT, nullptr, nullptr), ca.get()), std::nullopt);
}

// As often as the order of two certificates needs to come either way.
TEST_F(SignedText, IsSignedByTheCaItselfAloneAndByNoneThatItIssued) {
  for (int n = 0; n < 24; ++n) {
    const Key key = new_p256_key();
    const Certificate other = issued(key.get());
    EXPECT_EQ(verify_text(sign_text(kText, other.get(), key.get()), ca.get()), std::nullopt);
    EXPECT_EQ(
        verify_text(document(PKCS7_TEXT | PKCS7_DETACHED | PKCS7_PARTIAL, other.get(), key.get()), ca.get()),
        std::nullopt)
        << "two signers";
  }
}

// A list that was kept of each reading would be 96 bytes; the allocator's own stock grows less and less.
TEST_F(SignedText, IsReadWithoutKeepingMemory) {
  const std::string good = sign_text(kText, ca.get(), ca_key.get());
  constexpr double kMost = 200 * 64.0;
  double fewest = INFINITY;
  for (int block = 0; block < 5 && fewest > kMost; ++block) {
    const std::size_t before = mallinfo2().uordblks;
    for (int n = 0; n < 200; ++n) EXPECT_TRUE(verify_text(good, ca.get()));
    fewest = std::min(fewest, static_cast<double>(mallinfo2().uordblks) - static_cast<double>(before));
  }
  EXPECT_LE(fewest, kMost);
}

}  // namespace
}  // namespace biopsy::security
