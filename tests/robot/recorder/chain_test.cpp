// The bytes that are hashed and signed are those of docs/reference/procedure-log.md.
#include "robot/recorder/chain.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robot/recorder/log_csv.hpp"

namespace biopsy::recorder {
namespace {

std::string hex(const Sha256& hash) {
  Record record;
  record.hash = hash;
  const std::string line = csv_line(record);
  return line.substr(line.size() - 66, 64);
}

// Worked out by another program, in another language, from the page.
TEST(Chain, HashesAreThoseThatTheDocumentDefines) {
  LogId id;
  PublicKey key;
  for (std::size_t n = 0; n < id.size(); ++n) id[n] = static_cast<std::uint8_t>(n);
  for (std::size_t n = 0; n < key.size(); ++n) key[n] = static_cast<std::uint8_t>(200 + n);
  const LogHead empty = empty_head(id, key);
  EXPECT_EQ(hex(empty.last_hash), "c3298eed757a397a442fbd929b711d818549d1acb23f1f9663b1154aabb92a20");
  const Record record{.seq = 1,
                      .utc_ns = 1'795'000'000'123'456'789,
                      .mono_us = -5,
                      .source = "supervisor",
                      .kind = "state change",
                      .body = R"({"to":"hold","why":"größer"})",
                      .previous = empty.last_hash};
  EXPECT_EQ(hex(hash_of(record)), "9e79cf91a04190e484d309dbe9dff4ad8ea0f22ba6aa4aa0d1fee7bed8aa9ba2");
  const LogHead head{id, 1, hash_of(record)};
  EXPECT_EQ(signed_bytes(head).size(), 8U + 17U + 16U + 8U + 32U);
}

TEST(Csv, TextsAreQuotedAndTimesAreReadable) {
  const Record record{.seq = 3,
                      .utc_ns = 1'795'000'000'123'456'789,
                      .mono_us = 42,
                      .source = "stage",
                      .kind = "alarm",
                      .body = "he said \"stop\",\nthen nothing"};
  const std::string zeros(64, '0');
  EXPECT_EQ(csv_line(record),
            "3,2026-11-18 11:06:40.123456789,1795000000123456789,42,\"stage\",\"alarm\","
            "\"he said \"\"stop\"\",\nthen nothing\"," +
                zeros + "," + zeros + "\r\n");
}

TEST(Csv, AnyNumberIsATime) {
  EXPECT_EQ(utc_text(0), "1970-01-01 00:00:00.000000000");
  EXPECT_EQ(utc_text(-1), "1969-12-31 23:59:59.999999999");
  EXPECT_EQ(utc_text(INT64_MIN), "1677-09-21 00:12:43.145224192");
  EXPECT_EQ(utc_text(INT64_MAX), "2262-04-11 23:47:16.854775807");
}

}  // namespace
}  // namespace biopsy::recorder
