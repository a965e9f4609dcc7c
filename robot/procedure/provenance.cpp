#include "robot/procedure/provenance.hpp"

#include <fmt/format.h>

#include <span>

#include "robot/common/files/file.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"

namespace biopsy::robot {
namespace {

std::string file_hash(const std::filesystem::path& file) {
  return hex(sha256(read_file(file)));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance(const PreparedCase& prepared,
                                                            const report::RunRecord& record) {
  const Case& given = prepared.given;
  std::vector<std::pair<std::string, std::string>> out{
      {"program", fmt::format("biopsy {}", BIOPSY_VERSION)},
      {"seed", fmt::format("{}", given.seed)},
      {"image voxels, SHA-256", hex(sha256(std::as_bytes(std::span(prepared.image.voxels))))},
      {"plant model", given.rehearsal.model.filename().string()},
      {"plant model, SHA-256", file_hash(given.rehearsal.model)},
      {"tissues, SHA-256", file_hash(given.rehearsal.tissues)},
  };
  if (record.plan) out.emplace_back("seal of the plan, SHA-256", hex(record.plan->seal));
  return out;
}

std::vector<std::pair<std::string, std::string>> provenance_of_faults(const std::filesystem::path& file) {
  if (file.empty()) return {};
  return {{"faults", file.filename().string()}, {"faults, SHA-256", file_hash(file)}};
}

}  // namespace biopsy::robot
