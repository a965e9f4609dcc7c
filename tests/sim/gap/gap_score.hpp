// Score of a workflow (or of a peer) on hidden cases, as one table.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sim/gap/gap_finding.hpp"
#include "tests/sim/gap/generator/hidden_cases.hpp"

namespace biopsy::hidden {

struct AnsweredParameter {
  std::string name;
  double value = 0.0, std = 0.0;
};

struct AnsweredEffect {
  std::string name;
  double probability = 0.0;
  std::vector<std::string> confused_with;
  std::vector<AnsweredParameter> parameters;
};

struct Answer {
  std::string verdict;  // no_gap, parameter, effect, unexplained
  std::vector<AnsweredEffect> effects;
  std::vector<std::string> parameters_changed;
  double rmse_before = 0.0, rmse_after = 0.0, noise = 0.0, gap_closed = 0.0;  // mm
  double seconds = 0.0;
  std::vector<std::string> rejected = {}, objections = {};  // what came nearest to a name and why it is none
};

Answer answer_of(const GapFinding& finding);

struct Share {
  int right = 0, of = 0;
  void count(bool good) { right += good, ++of; }
  double percent() const { return of ? 100.0 * right / of : 0.0; }
};

class Score {
 public:
  void add(const HiddenCase& hidden, const Answer& answer);

  // The figures of docs/how-to/find-missing-effects.md. Nothing hidden: any effect or `unexplained` is a
  // false alarm; without parameter errors `parameter` is one too.
  Share right_first, right_or_tied, invented, false_alarm, both_names, one_name, parameter_found, unexplained,
      confident_wrong, wrong_name, inside_interval;
  std::vector<double> gap_closed, seconds;  // closed: something of the library was hidden
  std::vector<std::string>
      not_compared;  // true parameters the answer named otherwise: fix the table of cases
  double median_gap_closed() const;
  std::string list() const;  // a line a case: expected and found

 private:
  void compare_parameters(const HiddenCase& hidden, const Answer& answer);
  std::vector<std::string> lines_;
};

// Rows: figures with their bars; columns: the methods. Those that none of them has are left out.
std::vector<std::vector<std::string>> score_rows(const std::vector<std::pair<std::string, Score>>& methods);
// The same as a table in Markdown.
std::string score_table(const std::vector<std::pair<std::string, Score>>& methods);

}  // namespace biopsy::hidden
