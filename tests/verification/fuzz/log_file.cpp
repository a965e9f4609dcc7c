// Any bytes as a procedure log: a verdict, never worse; and what no key signed is never intact. The records
// that can be read go into CSV.
#include "robot/recorder/log_csv.hpp"
#include "robot/recorder/verify.hpp"
#include "tests/verification/fuzz/target.hpp"

FUZZ(log_file) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  const std::filesystem::path file = as_file("procedure.log", bytes);
  reads_or_refuses([&] {
    const recorder::Verdict verdict = recorder::verify(
        file, PublicKey{}, [](const recorder::Record& record) { recorder::csv_line(record); });
    claim(std::holds_alternative<recorder::Flaw>(verdict), "nobody holds the key of zeros");
  });
}
