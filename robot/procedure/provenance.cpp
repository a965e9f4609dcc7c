#include "robot/procedure/provenance.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <fstream>
#include <sstream>

#include "planner/plan/seal.hpp"

namespace biopsy::robot {
namespace {

std::string sha256(const void* bytes, std::size_t size) {
  Sha256 digest{};
  EVP_Digest(bytes, size, digest.data(), nullptr, EVP_sha256(), nullptr);
  return planner::hex(digest);
}

std::string file_hash(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  const std::string bytes = text.str();
  return sha256(bytes.data(), bytes.size());
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance(const PreparedCase& prepared,
                                                            const report::RunRecord& record) {
  const Case& given = prepared.given;
  std::vector<std::pair<std::string, std::string>> out{
      {"program", fmt::format("biopsy {}", BIOPSY_VERSION)},
      {"seed", fmt::format("{}", given.seed)},
      {"image voxels, SHA-256",
       sha256(prepared.image.voxels.data(), prepared.image.voxels.size() * sizeof(float))},
      {"plant model", given.rehearsal.model.filename().string()},
      {"plant model, SHA-256", file_hash(given.rehearsal.model)},
      {"tissues, SHA-256", file_hash(given.rehearsal.tissues)},
  };
  if (record.plan) out.emplace_back("seal of the plan, SHA-256", planner::hex(record.plan->seal));
  return out;
}

}  // namespace biopsy::robot
