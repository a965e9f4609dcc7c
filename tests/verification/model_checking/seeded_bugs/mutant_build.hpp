// Builds a copy of safety/ with one seeded bug, or none, as a shared object and loads it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "tests/verification/model_checking/seeded_bugs/bugs.hpp"
#include "tests/verification/model_checking/subject.hpp"

namespace biopsy::model_checking {

// Where sources, generated headers and compiler are, and where copies go.
struct MutantBuild {
  std::filesystem::path source, generated, compiler, bench;
};

// Checks that the copy with this bug compiles, which a static_assert of safety/ may forbid, without building
// it. Throws ConfigError where it does not.
void check_compiles(const MutantBuild& mutant_build, const SeededBug& bug);

class SeededSubject {
 public:
  // `bug` null: an unchanged copy. Throws ConfigError where it cannot be built.
  SeededSubject(const MutantBuild& mutant_build, const SeededBug* bug);
  const Subject& get() const { return subject_; }

 private:
  std::shared_ptr<void> library_;
  Subject subject_{};
};

}  // namespace biopsy::model_checking
