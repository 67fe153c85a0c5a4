// Damaged parts for `latvox merge`. The first byte chooses .vdb or .nvdb. Each further 12 bytes are a damage: an offset
// of 4 bytes, and 8 bytes that replace those there. Most of a part are masks of zeros, which no mutation of whole files
// reads.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "client/grid/part_file.h"
#include "client/internal/digest.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

constexpr uint64_t kMostBricks = 5000;  // of a damaged part: a tile of the root has 134 million

void Require(bool holds) {
  if (!holds) std::abort();
}

// Two uppers: one with a leaf, one with a leaf and a tile.
std::string WholePart(bool is_nano) {
  std::vector<Brick> bricks{{{-1, -2, -3}, {1, 0, 2}}, {{0, 0, 0}, kFullBrick}, {{5, 0, 0}, {0, 0, 0, 0, 0, 0, 0, 1}}};
  VoxelGrid grid({{{0.2, 0, 0}, {0, 0.2, 0}, {0.1, 0.1, 0.1}}, {1000, -2, 3e-5}, 0.1587});
  Require(grid.Add({bricks, 1}).ok());
  Digest digest;
  for (const Brick& brick : bricks) digest.Add(brick);
  Certificate certificate;
  certificate.lattice = "bcc";
  certificate.digest = digest.ToHex();
  grid.SetCertificate(certificate);
  std::string path = std::filesystem::temp_directory_path() / "latvox_part_fuzz.XXXXXX";
  const int file = mkstemp(path.data());
  Require(file >= 0);
  close(file);
  Require((is_nano ? grid.WriteNano(path) : grid.Write(path)).ok());
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  std::filesystem::remove(path);
  return std::move(bytes).str();
}

const std::string& Whole(bool is_nano) {
  static const std::string vdb = WholePart(false), nano = WholePart(true);
  return is_nano ? nano : vdb;
}

// Every part gives bricks or an error of the input.
void Merge(const std::string& path, bool is_whole) {
  const auto part = PartFile::Open(path);
  uint64_t bricks = 0;
  if (part.ok()) {
    while (bricks < kMostBricks && (*part)->Next()) ++bricks;
  }
  const absl::Status& status = part.ok() ? (*part)->status() : part.status();
  Require(status.ok() || status.code() == absl::StatusCode::kInvalidArgument);
  Require(!is_whole || (status.ok() && bricks == 3));
}

}  // namespace
}  // namespace latvox::client

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  std::string bytes = latvox::client::Whole(data[0] % 2 != 0);
  constexpr size_t kValue = 8;
  const uint8_t* const end = data + size;
  const bool is_whole = size < 1 + sizeof(uint32_t) + kValue;
  for (++data; static_cast<size_t>(end - data) >= sizeof(uint32_t) + kValue; data += sizeof(uint32_t) + kValue) {
    uint32_t offset = 0;
    std::memcpy(&offset, data, sizeof(offset));
    std::memcpy(&bytes[offset % (bytes.size() - kValue + 1)], data + sizeof(offset), kValue);
  }
  const int file = memfd_create("part", 0);
  if (file < 0 || write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  latvox::client::Merge("/proc/self/fd/" + std::to_string(file), is_whole);
  close(file);
  return 0;
}
