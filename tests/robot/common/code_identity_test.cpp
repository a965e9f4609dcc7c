// Which changes make evidence of before stale. Inputs: a tree written here.
#include "robot/common/code_identity.hpp"

#include <gtest/gtest.h>

#include <set>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy {
namespace {

void write(const ScratchFolder& tree, const std::filesystem::path& file, const std::string& content) {
  std::filesystem::create_directories((tree / file).parent_path());
  tree.write(file, content);
}

void write_tree(const ScratchFolder& tree) {
  for (const char* folder : {"cmake", "robot", "safety", "planner", "drivers", "sim", "tests"})
    write(tree, std::filesystem::path(folder) / "CMakeLists.txt", folder);
  write(tree, "CMakeLists.txt", "add_compile_options(-O2)");
  write(tree, "CMakePresets.json", "{}");
}

TEST(CodeFingerprint, ChangesWithEveryFileThatABuildOrAProofIsMadeOf) {
  const ScratchFolder tree;
  write_tree(tree);
  std::set<std::string> seen{code_fingerprint(tree.path())};
  for (const auto& [file, content] : {std::pair{"CMakeLists.txt", "add_compile_options(-O3)"},
                                      {"CMakePresets.json", "{\"version\": 3}"},
                                      {"cmake/Biopsy.cmake", "add_compile_options(-Wall)"},
                                      {"safety/gate.cpp", "int gate;"},
                                      {"safety/gate.cpp", "int  gate;"},
                                      {"sim/dense_ceres/without_suitesparse.c", "int none;"},
                                      {"robot/console/page/src/arm.tsx", "export {};"},
                                      {"tests/verification/coverage/measure", "#!/bin/sh"},
                                      {"tests/verification/fuzz/corpus/nothing", ""}}) {
    write(tree, file, content);
    EXPECT_TRUE(seen.insert(code_fingerprint(tree.path())).second) << file;
  }
}

TEST(CodeFingerprint, KeepsWithWhatTheTestsLeaveBehindAndWithDocuments) {
  const ScratchFolder tree;
  write_tree(tree);
  const std::string before = code_fingerprint(tree.path());
  write(tree, "tests/__pycache__/not_judged_test.cpython-311.pyc", "cached");
  write(tree, "robot/console/page/node_modules/react/index.js", "installed");
  write(tree, "docs/reference/safety-case.md", "words");
  write(tree, "build/dev/biopsy", "built");
  EXPECT_EQ(code_fingerprint(tree.path()), before);
}

TEST(CodeFingerprint, IsRefusedWithoutASourceTree) {
  const ScratchFolder folder;
  EXPECT_THROW(code_fingerprint(folder.path()), ConfigError);
}

}  // namespace
}  // namespace biopsy
