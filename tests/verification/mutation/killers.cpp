// The tests of the safety core over its mutated copy, each mutant in a process of its own.
//   killers --reach   runs every test with no mutant active and prints what each reached, as JSON
//   killers           reads orders, one a line: MUTANT MS TEST MS TEST ...; runs these tests with this mutant
//                     until one fails, and answers with the name of that test, or with -
// Each test may take so many milliseconds of processor time as the MS before its name says.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mutation.hpp"

namespace {

constexpr long kMostUseful_ms = 400;  // a slower test would cost more than all others together

bool passes(const std::string& test, long limit_ms) {
  testing::GTEST_FLAG(filter) = test;
  mutation::limit_time(limit_ms);
  return RUN_ALL_TESTS() == 0;
}

// Whether a process that does this work, and then ends, came to its end.
template <class Work>
bool ends_well(const Work& work) {
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    work();
    std::cout.flush();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::vector<std::string> all_tests() {
  std::vector<std::string> names;
  const testing::UnitTest& unit = *testing::UnitTest::GetInstance();
  for (int i = 0; i < unit.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *unit.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j)
      names.push_back(std::string(suite.name()) + '.' + suite.GetTestInfo(j)->name());
  }
  return names;
}

std::string reached() {
  std::string numbers;
  for (std::size_t i = 0; i < mutation::kMostMutants; ++i)
    if (mutation::reached[i]) numbers += (numbers.empty() ? "" : ",") + std::to_string(i);
  return '[' + numbers + ']';
}

void print_reach() {
  std::cout << R"({"before_main": )" << reached() << R"(, "tests": [)";
  const char* separator = "\n";
  for (const std::string& test : all_tests()) {
    std::cout << std::exchange(separator, ",\n") << R"({"name": ")" << test << '"';
    const bool in_time = ends_well([&] {
      std::fill_n(mutation::reached, mutation::kMostMutants, false);
      const std::clock_t start = std::clock();
      const bool passed = passes(test, kMostUseful_ms);
      std::cout << R"(, "ms": )" << (std::clock() - start) * 1'000.0 / CLOCKS_PER_SEC << R"(, "passed": )"
                << (passed ? "true" : "false") << R"(, "reached": )" << reached();
    });
    std::cout << R"(, "in_time": )" << (in_time ? "true" : "false") << '}';
  }
  std::cout << "]}\n";
}

void follow_orders() {
  testing::GTEST_FLAG(break_on_failure) = true;  // the first failed expectation ends the process
  void* shared = mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  volatile int* running = static_cast<int*>(shared);
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream order(line);
    int mutant = 0;
    order >> mutant;
    std::vector<std::pair<long, std::string>> tests;
    for (std::pair<long, std::string> each; order >> each.first >> each.second;) tests.push_back(each);
    const bool survived = ends_well([&] {
      mutation::active = mutant;
      (void)std::freopen("/dev/null", "w", stdout);  // what tests and their children print is no answer
      for (*running = 0; *running < static_cast<int>(tests.size()); *running = *running + 1) {
        const auto& [limit_ms, name] = tests[static_cast<std::size_t>(*running)];
        if (!passes(name, limit_ms)) std::abort();
      }
    });
    std::cout << (survived ? "-" : tests[static_cast<std::size_t>(*running)].second) << std::endl;
  }
}

}  // namespace

int main(int argc, char** argv) {
  int one = 1;
  testing::InitGoogleTest(&one, argv);
  testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
  delete listeners.Release(listeners.default_result_printer());
  mutation::limit_time(0);  // of this process; those that it starts have limits of their own
  if (argc == 2 && std::strcmp(argv[1], "--reach") == 0)
    print_reach();
  else
    follow_orders();
  return 0;
}
