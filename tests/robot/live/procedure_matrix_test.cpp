// Every built-in case and a patient's case through the real processes, in real time.
#include "tests/robot/live/steady_host.hpp"
#include "tests/robot/procedure/matrix_cases.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

class LiveProcedureMatrix : public testing::TestWithParam<std::pair<const std::string, int>> {};

TEST_P(LiveProcedureMatrix, CompletesWithOneImageOfEachStep) {
  live_tests::on_a_steady_host([]() -> std::string {
    const ScratchFolder folder;
    const auto answer = cli_tests::biopsy("dry-run --live " + case_file(GetParam().first) +
                                          " --domain 85 --out " + (folder / "out").string());
    if (answer.code == 3) return "the procedure was stopped\n" + answer.text;
    EXPECT_EQ(answer.code, 0) << answer.text;
    if (answer.code == 0) {
      EXPECT_EQ(folders_in(folder / "out/images"), static_cast<std::size_t>(GetParam().second));
    }
    return {};
  });
}

INSTANTIATE_TEST_SUITE_P(Cases, LiveProcedureMatrix, testing::ValuesIn(kImages), [](const auto& given) {
  return given.param.first == kPatientsCase ? "patient" : given.param.first;
});

}  // namespace
}  // namespace biopsy::robot
