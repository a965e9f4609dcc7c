// biopsy-mpi: a campaign on the ranks of an MPI job. Each rank runs `biopsy ... --shard RANK/SIZE` as a process of
// its own; when all are done the first puts the parts together. A shard that is there is not run again, so that a job
// that lost a rank is started anew as it was.
#include <fmt/format.h>
#include <mpi.h>

#include <filesystem>
#include <string>
#include <vector>

#include "robot/common/subprocess.hpp"

namespace {

namespace fs = std::filesystem;

// MPI of this process, from construction to the end.
class Ranks {
 public:
  Ranks(int& argc, char**& argv) {
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~Ranks() { MPI_Finalize(); }
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }
  // The largest of all ranks' numbers; waits for all.
  int largest(int own) const {
    int out = own;
    MPI_Allreduce(&own, &out, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
    return out;
  }

 private:
  int rank_ = 0, size_ = 1;
};

int run(const Ranks& ranks, std::vector<std::string> words) {
  words.insert(words.begin(), fs::read_symlink("/proc/self/exe").parent_path() / "biopsy");
  const auto with = [&](const std::string& option, const std::string& value) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {option, value});
    return biopsy::run_subprocess(all, {}, true);
  };
  const biopsy::ProcessResult own = with("--shard", fmt::format("{}/{}", ranks.rank() + 1, ranks.size()));
  if (own.exit_code != 0)
    fmt::print(stderr, "rank {} of {}: exit code {}\n{}", ranks.rank(), ranks.size(), own.exit_code, own.text);
  if (const int worst = ranks.largest(own.exit_code); worst != 0) return worst;
  int code = 0;
  if (ranks.rank() == 0) {
    const biopsy::ProcessResult merged = with("--merge", fmt::format("{}", ranks.size()));
    fmt::print("{}", merged.text);
    code = merged.exit_code;
  }
  return ranks.largest(code);
}

}  // namespace

int main(int argc, char** argv) {
  const Ranks ranks(argc, argv);
  if (argc < 2) {
    if (ranks.rank() == 0)
      fmt::print(stderr, "error: no command; for example\n  mpirun -n 2 biopsy-mpi campaign liver --out out/campaign\n");
    return 2;
  }
  return run(ranks, {argv + 1, argv + argc});
}
