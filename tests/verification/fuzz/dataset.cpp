// Data sets: the description, a line of %, and the one run it names. Only finite numbers in rows of one
// length come out.
#include "sim/plant/dataset.hpp"

#include <cmath>

#include "tests/verification/fuzz/target.hpp"

namespace {

void claim_finite(const std::vector<double>& numbers, std::size_t rows) {
  biopsy::fuzz::claim(numbers.empty() || numbers.size() == rows, "columns of one length");
  for (const double number : numbers) biopsy::fuzz::claim(std::isfinite(number), "finite numbers only");
}

}  // namespace

FUZZ(dataset) {
  using namespace biopsy;
  using namespace biopsy::fuzz;
  const std::string text = text_of(bytes);
  const std::size_t cut = std::min(text.find("\n%\n"), text.size());
  const std::filesystem::path description = as_file("dataset.toml", bytes.first(cut));
  as_file("a.csv", bytes.subspan(std::min(cut + 3, bytes.size())));
  for (const sim::Drive drive : {sim::Drive::Stack, sim::Drive::Force})
    reads_or_refuses([&] {
      const sim::Dataset dataset = sim::read_dataset(description.parent_path(), drive);
      for (const sim::RecordedRun& run : dataset.runs) {
        claim(run.period > 0.0 && !run.time.empty(), "a run has rows, and time between them");
        claim(run.input.size() == run.time.size(), "an input a row");
        for (const auto* column : {&run.time, &run.input, &run.displacement, &run.plate_b, &run.current})
          claim_finite(*column, run.time.size());
      }
    });
}
