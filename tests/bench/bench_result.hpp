// Figures of a bench: printed, kept as a file with the machine that gave them, and held against earlier ones.
// A machine is known only beside others, so what is held is each figure's ratio to a peer measured in the same
// run, not its time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace biopsy::bench {

// CPU time of this thread, s: what others do on the machine does not count.
double cpu_s();

struct Figure {
  std::string name;    // "lockstep"
  std::string what;    // for people
  double ns = 0.0;     // CPU time of a tick
  std::string remark;  // accuracy
};

class BenchResult {
 public:
  void add(Figure figure);  // and prints it
  // The figure by which all others are divided.
  void set_peer(const std::string& name) { peer_ = name; }

  // name, ns, x real time, ratio to the peer; processor, compiler, load.
  void write(const std::filesystem::path& file) const;
  // Figures that need more than 1.25 of what `file` says in units of the peer (a fifth of the speed lost), as
  // text; empty where there are none. Throws ConfigError for a file without them.
  std::string losses(const std::filesystem::path& file) const;

 private:
  double ratio(const Figure& figure) const;

  std::vector<Figure> figures_;
  std::string peer_;
};

}  // namespace biopsy::bench
