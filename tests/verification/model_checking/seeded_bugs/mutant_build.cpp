#include "tests/verification/model_checking/seeded_bugs/mutant_build.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::model_checking {
namespace {

namespace fs = std::filesystem;

void copy_with_bug(const fs::path& from, const fs::path& to, const SeededBug* bug) {
  fs::remove_all(to);
  fs::create_directories(to.parent_path());
  fs::copy(from, to, fs::copy_options::recursive);
  if (bug == nullptr) return;
  const std::string text = with_bug(*bug, read_file(from / bug->file, "run from a complete source tree"));
  atomic_write(to / bug->file, text);
}

// The copy with this bug, or none, by the compiler and `how`.
void compile(const MutantBuild& mutant_build, const SeededBug* bug, const std::string& how) {
  const std::string name(bug != nullptr ? bug->id : "unchanged");
  const fs::path bench = mutant_build.bench / name, errors = bench / "errors.txt";
  copy_with_bug(mutant_build.source / "safety", bench / "safety", bug);
  const std::string command = fmt::format(
      "cd '{}' && '{}' -std=c++20 -w {} -I. -I'{}' -I'{}' '{}' 2> errors.txt", bench.string(),
      mutant_build.compiler.string(), how, mutant_build.source.string(), mutant_build.generated.string(),
      (mutant_build.source / "tests/verification/model_checking/seeded_bugs/shared_object.cpp").string());
  if (std::system(command.c_str()) != 0)
    throw ConfigError(fmt::format("the copy with seeded bug {} does not compile", name), errors.string(),
                      "read the compiler's words there");
}

constexpr const char* kObject = "seeded.so";

}  // namespace

void check_compiles(const MutantBuild& mutant_build, const SeededBug& bug) {
  compile(mutant_build, &bug, "-fsyntax-only");
}

SeededSubject::SeededSubject(const MutantBuild& mutant_build, const SeededBug* bug) {
  compile(mutant_build, bug, fmt::format("-O2 -shared -fPIC -fvisibility=hidden -o {}", kObject));
  const fs::path object = mutant_build.bench / (bug != nullptr ? bug->id : "unchanged") / kObject;
  library_ = {dlopen(object.c_str(), RTLD_NOW | RTLD_LOCAL), [](void* library) {
                if (library != nullptr) dlclose(library);
              }};
  if (!library_) throw ConfigError(dlerror(), object.string(), "build again");
  subject_.step = reinterpret_cast<decltype(subject_.step)>(dlsym(library_.get(), "seeded_step"));
  subject_.gate = reinterpret_cast<decltype(subject_.gate)>(dlsym(library_.get(), "seeded_gate"));
  if (subject_.step == nullptr || subject_.gate == nullptr)
    throw ConfigError("lacks its two functions", object.string(), "build again");
}

}  // namespace biopsy::model_checking
