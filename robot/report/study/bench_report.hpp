// The experiments on the bench, for a person; the data themselves are the data set beside the report.
#pragma once

#include <string>
#include <vector>

namespace biopsy::report {

struct BenchRunRecord {
  std::string name, file, what;
  double weight_g = 0.0;
  std::string stopped_because;  // empty: played to its end
  double stopped_s = 0.0;
  double expected_mm = 0.0;                                       // of the nominal stage
  std::vector<double> time_s, drive_kV, displacement_mm, push_N;  // rows of the data set
};

struct BenchRecord {
  std::string title;  // as in dataset.toml
  std::string device, model;
  bool simulated = true;
  std::vector<std::string> notes;
  std::size_t planned_runs = 0;
  std::vector<BenchRunRecord> runs;  // that were begun
  double sensor_noise_mm = 0.0;      // 0: not measured
};

// A self-contained page: experiments, a table, a picture of each run.
std::string bench_html(const BenchRecord& record);

// The table for a terminal, one line a run.
std::string bench_console(const BenchRecord& record);

}  // namespace biopsy::report
