// Every alteration of a log is found: of bits, of records, and by a forger who knows the format but not the
// key.
#include <fmt/format.h>

#include <random>

#include "robot/common/config_error.hpp"
#include "tests/robot/recorder/log_for_tests.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::recorder {
namespace {

constexpr std::int64_t kRecords = 40;

const std::vector<std::string> kColumns{"seq",  "utc_ns", "mono_us",  "source",
                                        "kind", "body",   "previous", "hash"};

// One bit of one column of one row, other things equal. Returns whether there was such a bit.
bool flip_bit(const fs::path& log, const std::string& table, const std::string& column, std::int64_t row,
              std::mt19937& random) {
  int code = SQLITE_OK;
  Database database("file:" + log.string(), SQLITE_OPEN_READWRITE, &code);
  database.execute("PRAGMA synchronous = OFF");
  Statement read(database, fmt::format("SELECT {} FROM {} WHERE rowid = {}", column, table, row).c_str());
  Statement write(
      database, fmt::format("UPDATE OR REPLACE {} SET {} = ?1 WHERE rowid = {}", table, column, row).c_str());
  EXPECT_EQ(read.step(), SQLITE_ROW);
  std::vector<std::uint8_t> blob;
  std::string text;
  if (const auto integer = read.integer(0)) {
    write.bind(1, *integer ^ static_cast<std::int64_t>(std::uint64_t{1} << random() % 64));
  } else if (auto letters = read.text(0)) {
    if (letters->empty()) return false;
    text = *letters;
    text[random() % text.size()] ^= static_cast<char>(1U << random() % 8);
    write.bind(1, text);
  } else {
    for (const std::size_t size : {16U, 32U, 64U}) {
      blob.resize(size);
      if (read.bytes(0, blob)) break;
    }
    blob[random() % blob.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    write.bind(1, blob);
  }
  EXPECT_EQ(read.step(), SQLITE_DONE);
  EXPECT_TRUE(write.finish()) << database.message();
  return true;
}

// A new file each time: to cut an old one down to nothing and fill it again makes the file system wait.
void replace(const fs::path& file, const std::string& content) {
  fs::remove(file);
  write_content(file, content);
}

TEST(Tampering, OneFlippedBitInAnyColumnOfAnyRecordIsFound) {
  verifies("R-45");
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  std::mt19937 random(7);
  for (const std::string& column : kColumns)
    for (int trial = 0; trial < 120; ++trial) {
      replace(folder.log, whole);
      const auto row = static_cast<std::int64_t>(random() % kRecords) + 1;
      ASSERT_TRUE(flip_bit(folder.log, "record", column, row, random));
      const Verdict verdict = folder.verdict();
      ASSERT_FALSE(is_intact(verdict)) << column << " of record " << row;
      // A number that now is too low moves its record to the front, so it shows there.
      if (column != "seq") {
        EXPECT_EQ(std::get<Flaw>(verdict).record, row) << column << ": " << text_of(verdict);
      }
    }
}

TEST(Tampering, OneFlippedBitInTheHeadIsFound) {
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  std::mt19937 random(8);
  for (const std::string column : {"one", "log_id", "public_key", "count", "last_hash", "signature"})
    for (int trial = 0; trial < 60; ++trial) {
      replace(folder.log, whole);
      ASSERT_TRUE(flip_bit(folder.log, "head", column, 1, random));
      const Verdict verdict = folder.verdict();
      ASSERT_FALSE(is_intact(verdict)) << column;
      EXPECT_EQ(text_of(verdict), column == "public_key" ? "other key 0" : "head altered 0");
    }
}

TEST(Tampering, AFlippedBitOfTheFileIsFoundOrTouchedNothingThatWasWritten) {
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  const auto written = records_of(folder.log, folder.public_key());
  std::mt19937 random(9);
  int found = 0;
  constexpr int kTrials = 1500;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::string altered = whole;
    altered[random() % altered.size()] ^= static_cast<char>(1U << random() % 8);
    replace(folder.log, altered);
    std::vector<Record> read;
    const Verdict verdict =
        verify(folder.log, folder.public_key(), [&](const Record& record) { read.push_back(record); });
    found += is_intact(verdict) ? 0 : 1;
    if (!is_intact(verdict)) continue;
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t n = 0; n < read.size(); ++n) {
      ASSERT_EQ(hash_of(read[n]), written[n].hash);
      ASSERT_EQ(read[n].body, written[n].body);
    }
  }
  std::size_t content = 0;
  for (const Record& record : written)
    content += record.source.size() + record.kind.size() + record.body.size() + 2 * sizeof(Sha256);
  EXPECT_GT(found, 0.9 * kTrials * static_cast<double>(content) / static_cast<double>(whole.size()));
}

TEST(Tampering, ATruncatedFileIsFoundWhereverItIsCut) {
  verifies("R-45");
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    replace(folder.log, whole.substr(0, size));
    EXPECT_FALSE(is_intact(folder.verdict())) << size << " of " << whole.size() << " bytes";
  }
}

struct Alteration {
  std::string sql, finding;
};

TEST(Tampering, DeletedSwappedMovedAndAddedRecordsAreNamed) {
  verifies("R-45");
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  const std::string all = "utc_ns, mono_us, source, kind, body, previous, hash";
  const std::vector<Alteration> alterations{
      {"DELETE FROM record WHERE seq = 1", "record missing 1"},
      {"DELETE FROM record WHERE seq BETWEEN 17 AND 19", "record missing 17"},
      {"DELETE FROM record WHERE seq = 40", "records cut off 40"},
      {"DELETE FROM record", "records cut off 1"},
      {"DELETE FROM head", "head altered 0"},
      {"DELETE FROM record WHERE seq = 40; UPDATE head SET count = 39, last_hash = (SELECT hash FROM record "
       "WHERE seq = 39)",
       "head altered 0"},
      {"DELETE FROM record WHERE seq = 17; UPDATE record SET seq = seq - 1 WHERE seq > 17",
       "record altered 17"},
      {"UPDATE record SET seq = 99 WHERE seq = 5; UPDATE record SET seq = 5 WHERE seq = 6; UPDATE record SET "
       "seq = 6 WHERE seq = 99",
       "record altered 5"},
      {"INSERT INTO record SELECT 41, " + all + " FROM record WHERE seq = 40", "record altered 41"},
      {"INSERT INTO record SELECT -3, " + all + " FROM record WHERE seq = 3", "record missing 1"},
      {"CREATE TABLE more(a)", "not a log 0"},
      {"CREATE TRIGGER t AFTER INSERT ON record BEGIN DELETE FROM record; END", "not a log 0"},
      {"ALTER TABLE record ADD COLUMN note TEXT", "not a log 0"},
      {"DROP TABLE record", "not a log 0"},
  };
  for (const Alteration& alteration : alterations) {
    replace(folder.log, whole);
    tamper(folder.log, alteration.sql);
    EXPECT_EQ(text_of(folder.verdict()), alteration.finding) << alteration.sql;
  }
}

TEST(Tampering, AnEmptyTextMadeAnotherKindOfEmptyIsFound) {
  const LogFolder folder;
  {
    Recorder recorder(folder.log, folder.key());
    Entry silent = entry(1);
    silent.body = "";
    recorder.append(silent, Urgency::Urgent, 0);
  }
  const std::string schema = "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = ";
  tamper(folder.log, schema + "replace(sql, ' STRICT', '')");
  tamper(folder.log, "UPDATE record SET body = x''");
  tamper(folder.log, schema + "sql || ' STRICT'");
  EXPECT_EQ(text_of(folder.verdict()), "record altered 1");
}

std::string blob(const Sha256& hash) {
  return fmt::format("x'{:02x}'", fmt::join(hash, ""));
}

// Gives record `seq` another body and hashes that fit it; `chained` as well all behind it.
void forge(const LogFolder& folder, std::uint64_t seq, bool chained, bool head) {
  auto records = records_of(folder.log, folder.public_key());
  records[seq - 1].body = "forged";
  std::string sql;
  for (std::size_t n = seq - 1; n < (chained ? records.size() : seq); ++n) {
    if (n >= seq) records[n].previous = records[n - 1].hash;
    records[n].hash = hash_of(records[n]);
    sql += fmt::format("UPDATE record SET body = '{}', previous = {}, hash = {} WHERE seq = {};",
                       records[n].body, blob(records[n].previous), blob(records[n].hash), n + 1);
  }
  if (head) sql += fmt::format("UPDATE head SET last_hash = {};", blob(records.back().hash));
  tamper(folder.log, sql);
}

TEST(Tampering, AForgerWhoKnowsTheFormatIsFound) {
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  forge(folder, 12, false, false);
  EXPECT_EQ(text_of(folder.verdict()), "record out of place 13") << "its successor holds the old hash";
  replace(folder.log, whole);
  forge(folder, 12, true, false);
  EXPECT_EQ(text_of(folder.verdict()), "rewritten 40");
  replace(folder.log, whole);
  forge(folder, 12, true, true);
  EXPECT_EQ(text_of(folder.verdict()), "head altered 0");
}

TEST(Tampering, RecordsAndHeadsOfOtherTimesAndLogsAreFound) {
  verifies("R-45");
  const LogFolder folder(kRecords);
  const std::string whole = file_content(folder.log);
  folder.write(folder.scratch / "other.log", kRecords);  // same key, same records, another log
  const std::string with_other =
      fmt::format("ATTACH '{}' AS other;", (folder.scratch / "other.log").string());
  const std::string take = with_other + "INSERT OR REPLACE INTO record SELECT * FROM other.record WHERE seq ";
  for (const auto& [which, finding] : std::vector<Alteration>{{"= 9", "record out of place 9"},
                                                              {">= 9", "record out of place 9"},
                                                              {"> 0", "record out of place 1"}}) {
    replace(folder.log, whole);
    tamper(folder.log, take + which);
    EXPECT_EQ(text_of(folder.verdict()), finding) << which;
  }
  replace(folder.log, whole);
  tamper(folder.log, with_other + "INSERT OR REPLACE INTO head SELECT * FROM other.head");
  EXPECT_EQ(text_of(folder.verdict()), "record out of place 1");

  fs::copy_file(folder.log, folder.scratch / "early.log", fs::copy_options::overwrite_existing);
  replace(folder.log, whole);
  write_content(folder.scratch / "early.log", whole);
  folder.write(folder.log, 3);
  tamper(folder.log, fmt::format("ATTACH '{}' AS early; INSERT OR REPLACE INTO head SELECT * FROM early.head",
                                 (folder.scratch / "early.log").string()));
  EXPECT_EQ(text_of(folder.verdict()), "record added 41");
}

TEST(Tampering, ALogOfAnotherKeyIsNotTakenForThisOne) {
  const LogFolder folder(kRecords), other(3);
  EXPECT_EQ(text_of(verify(folder.log, other.public_key())), "other key 0");
  // A whole log made by a other, that names our key as its own.
  tamper(other.log, fmt::format("UPDATE head SET public_key = {}", blob(folder.public_key())));
  EXPECT_EQ(text_of(verify(other.log, folder.public_key())), "head altered 0");
}

TEST(Tampering, RandomBytesAreNoLogAndAreRefusedWithASentence) {
  const LogFolder folder(1);
  const std::string header = file_content(folder.log).substr(0, 100);
  std::mt19937 random(10);
  for (int trial = 0; trial < 500; ++trial) {
    std::string bytes(random() % 20'000, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    if (trial % 2) bytes = header + bytes;
    replace(folder.log, bytes);
    const Verdict verdict = folder.verdict();
    ASSERT_FALSE(is_intact(verdict));
    const Flaw& flaw = std::get<Flaw>(verdict);
    EXPECT_TRUE(flaw.kind == FlawKind::NotALog || flaw.kind == FlawKind::Damaged) << text_of(verdict);
    EXPECT_FALSE(flaw.what.empty());
  }
  EXPECT_THROW((void)verify(folder.scratch / "absent.log", folder.public_key()), ConfigError);
  EXPECT_THROW((void)verify(folder.scratch.path(), folder.public_key()), ConfigError);
}

}  // namespace
}  // namespace biopsy::recorder
