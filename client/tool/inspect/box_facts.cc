#include "client/tool/inspect/box_facts.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

struct BinvoxHeader {
  std::array<uint64_t, 3> shape{};
  Vec3d corner{};
  double scale = 1;
};

// Reads "#binvox 1", then lines "dim X Z Y", "translate ...", "scale ..." in any order, and "data".
absl::StatusOr<BinvoxHeader> ReadBinvoxHeader(FileSource& file) {
  constexpr uint64_t kMostSide = 1 << 20;
  BinvoxHeader header;
  std::string line;
  for (int lines = 0; line != "data"; ++lines) {
    const auto more = file.ReadLine(line);
    if (!more.ok()) return more.status();
    if (!*more || lines > 16 || (lines == 0 && line != "#binvox 1")) return file.Bad("has no header of a .binvox");
    const std::vector<std::string> words = absl::StrSplit(line, ' ');
    bool good = true;
    for (size_t m = 0; m < 3 && words[0] == "dim"; ++m) {
      good &= words.size() == 4 && absl::SimpleAtoi(words[m + 1], &header.shape[m]) && header.shape[m] <= kMostSide;
    }
    for (size_t m = 0; m < 3 && words[0] == "translate"; ++m) {
      good &= words.size() == 4 && absl::SimpleAtod(words[m + 1], &header.corner[m]);
    }
    if (words[0] == "scale") good = words.size() == 2 && absl::SimpleAtod(words[1], &header.scale);
    if (!good) return file.Bad("line \"", line, "\" is wrong");
  }
  if (*std::min_element(header.shape.begin(), header.shape.end()) == 0) return file.Bad("has no dim above 0");
  return header;
}

uint32_t WordAt(const char* bytes) {
  uint32_t word;
  std::memcpy(&word, bytes, sizeof(word));
  return word;
}

}  // namespace

absl::StatusOr<Json> BinvoxFacts(FileSource& file) {
  const auto header = ReadBinvoxHeader(file);
  if (!header.ok()) return header.status();
  const uint64_t cells = header->shape[0] * header->shape[1] * header->shape[2];
  uint64_t all = 0, voxels = 0;
  std::string runs(size_t{1} << 16, '\0');
  for (size_t got = runs.size(); got == runs.size();) {
    const auto read = file.ReadSome(runs.data(), runs.size());
    if (!read.ok()) return read.status();
    got = *read;
    for (size_t n = 0; n + 1 < got; n += 2) {
      const uint64_t length = static_cast<uint8_t>(runs[n + 1]);
      all += length;
      if (runs[n] != 0) voxels += length;
    }
  }
  if (all != cells) return file.Bad("has runs of ", all, " cells, not ", cells);
  return Json{{"voxels", voxels},
              {"shape", header->shape},
              {"voxel_size", header->scale / static_cast<double>(header->shape[0])},
              {"low_corner", header->corner}};
}

absl::StatusOr<Json> VoxFacts(FileSource& file) {
  std::array<char, 20> head;
  if (auto status = file.Read(head.data(), head.size()); !status.ok()) return status;
  if (!absl::StartsWith({head.data(), head.size()}, "VOX ") || absl::string_view(&head[8], 4) != "MAIN") {
    return file.Bad("is not a .vox file");
  }
  if (auto status = file.Skip(WordAt(&head[12])); !status.ok()) return status;
  if (file.size() - file.at() != WordAt(&head[16])) return file.Bad("is cut short, or goes on after its content");
  uint64_t voxels = 0, models = 0;
  Json shape;
  while (file.at() < file.size()) {  // a chunk: id, bytes of content, bytes of subchunks
    std::array<char, 12> chunk;
    if (auto status = file.Read(chunk.data(), chunk.size()); !status.ok()) return status;
    const absl::string_view id(chunk.data(), 4);
    uint64_t bytes = WordAt(&chunk[4]);
    std::array<char, 12> content{};
    const size_t wanted = id == "SIZE" ? 12 : id == "XYZI" ? 4 : 0;
    if (bytes < wanted) return file.Bad("has a short chunk ", id);
    if (auto status = file.Read(content.data(), wanted); !status.ok()) return status;
    if (id == "SIZE") shape = {WordAt(&content[0]), WordAt(&content[4]), WordAt(&content[8])};
    if (id == "XYZI") {
      voxels += WordAt(content.data());
      if (uint64_t{4} * WordAt(content.data()) != bytes - wanted) return file.Bad("has a chunk XYZI of another length");
      ++models;
    }
    bytes += WordAt(&chunk[8]) - wanted;
    if (auto status = file.Skip(bytes); !status.ok()) return status;
  }
  Json facts = {{"voxels", voxels}};
  if (models == 1) {
    facts["shape"] = shape;
  } else {
    facts["models"] = models;
  }
  return facts;
}

}  // namespace latvox::client
