// Bits flipped over the whole length of every file of a set of keys.
#include <openssl/pem.h>

#include <functional>
#include <random>

#include "tests/robot/security/check_keys_bench.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

// What a file contains, read by other calls than the tested code uses.
using Meaning = std::function<std::string(const std::string&)>;

std::string der_of_pem(const std::string& content) {
  const Bio in(BIO_new_mem_buf(content.data(), static_cast<int>(content.size())));
  char* name = nullptr;
  char* header = nullptr;
  unsigned char* data = nullptr;
  long size = 0;
  if (PEM_read_bio(in.get(), &name, &header, &data, &size) != 1) return "";
  const std::string der(reinterpret_cast<char*>(data), static_cast<std::size_t>(size));
  OPENSSL_free(name);
  OPENSSL_free(header);
  OPENSSL_free(data);
  return der;
}

// The private scalar and the public point; the rest of PKCS #8 is encoding.
std::string key_numbers(const std::string& content) {
  const Bio in(BIO_new_mem_buf(content.data(), static_cast<int>(content.size())));
  const Key key(PEM_read_bio_PrivateKey(
      in.get(), nullptr, [](char*, int, int, void*) { return -1; }, nullptr));
  if (!key) return "";
  const Bio out = writer();
  EVP_PKEY_print_private(out.get(), key.get(), 0, nullptr);
  return written(out);
}

// The signed text without the S/MIME around it.
std::string signed_xml(const std::string& content) {
  const std::size_t from = content.find("<?xml"), to = content.find("</dds>");
  return from == std::string::npos || to == std::string::npos ? "" : content.substr(from, to - from);
}

// Over the whole length of a file: a flipped bit is detected, or does not change the contents.
void flip_bits(const fs::path& file, const Meaning& meaning, const std::function<bool()>& is_accepted) {
  const std::string good = file_content(file);
  const std::string meant = meaning(good);
  ASSERT_FALSE(meant.empty());
  std::mt19937 random(20261121);
  int found = 0;
  constexpr int kFlips = 150;
  for (int flip = 0; flip < kFlips; ++flip) {
    std::string bad = good;
    const std::size_t bit = std::uniform_int_distribution<std::size_t>(0, 8 * good.size() - 1)(random);
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    write_content(file, bad);
    if (is_accepted())
      EXPECT_EQ(meaning(bad), meant) << file << ": bit " << bit << " is not detected";
    else
      ++found;
  }
  write_content(file, good);
  EXPECT_GT(found, kFlips * 3 / 4) << file;
}

TEST_F(CheckKeys, AFlippedBitIsDetectedOrChangesNothing) {
  const auto stage_is_accepted = [this] { return stage_problem().empty(); };
  for (const fs::path& file : {files_.identity_ca, files_.permissions_ca, files_.identity})
    flip_bits(file, der_of_pem, stage_is_accepted);
  flip_bits(files_.private_key, key_numbers, stage_is_accepted);
  for (const fs::path& file : {files_.governance, files_.permissions})
    flip_bits(file, signed_xml, stage_is_accepted);
  for (const Signer signer : kSigners) {
    const SigningFiles files = signing_files(set_.folder(), signer);
    const auto is_accepted = [this, signer] {
      for (const FileVerdict& verdict : inspect_signing_keys(set_.folder(), signer))
        if (!verdict.problem.empty()) return false;
      return true;
    };
    flip_bits(files.private_key, key_numbers, is_accepted);
    flip_bits(files.public_key, der_of_pem, is_accepted);
  }
}

}  // namespace
}  // namespace biopsy::security
