#include "client/tool/inspect/vtk_facts.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace latvox::client {
namespace {

// Returns the value of an attribute, or "".
std::string Attribute(const std::string& line, const std::string& name) {
  const std::string before = absl::StrCat(" ", name, "=\"");
  const size_t begin = line.find(before);
  if (begin == std::string::npos) return "";
  const size_t from = begin + before.size();
  return line.substr(from, line.find('"', from) - from);
}

template <size_t N>
bool ReadAttribute(const std::string& text, std::array<double, N>& numbers) {
  const std::vector<std::string> words = absl::StrSplit(text, ' ');
  if (words.size() != N) return false;
  for (size_t n = 0; n < N; ++n) {
    if (!absl::SimpleAtod(words[n], &numbers[n])) return false;
  }
  return true;
}

struct VtkHead {
  std::string kind;   // line of the element of this kind
  std::string piece;  // line of the piece
  Json arrays = Json::object();
};

// Reads up to the first byte of appended data.
absl::StatusOr<VtkHead> ReadHead(FileSource& file, const std::string& kind) {
  constexpr size_t kMostLines = 64;
  VtkHead head;
  std::string line;
  bool is_ours = false, is_data = true;  // is_data: before the arrays of positions and cells
  for (size_t n = 0; n < kMostLines && !absl::StartsWith(line, "<AppendedData"); ++n) {
    const auto more = file.ReadLine(line);
    if (!more.ok()) return more.status();
    if (!*more) return file.Bad("is cut short");
    if (n == 0 && line != "<?xml version=\"1.0\"?>") return file.Bad("does not begin as a file of VTK");
    if (absl::StartsWith(line, "<VTKFile ")) is_ours = Attribute(line, "compressor") == "vtkZLibDataCompressor";
    if (absl::StartsWith(line, absl::StrCat("<", kind))) head.kind = line;
    if (absl::StartsWith(line, "<Piece ")) head.piece = line;
    if (absl::StartsWith(line, "<Points>")) is_data = false;
    if (is_data && absl::StartsWith(line, "<DataArray "))
      head.arrays[Attribute(line, "Name")] = Attribute(line, "type");
  }
  char underscore = 0;
  if (auto status = file.Read(&underscore, 1); !status.ok()) return status;
  if (!is_ours || head.kind.empty() || head.piece.empty() || underscore != '_') {
    return file.Bad("is not a file of latvox with an element ", kind);
  }
  return head;
}

// Counts the bytes of the next array that are not 0.
absl::StatusOr<uint64_t> CountBytes(FileSource& file, uint64_t bytes) {
  constexpr uint64_t kBlock = uint64_t{1} << 20;
  std::array<uint64_t, 3> sizes{};
  if (auto status = file.Read(sizes.data(), sizeof(sizes)); !status.ok()) return status;
  const uint64_t blocks = (bytes + kBlock - 1) / kBlock;
  if (sizes != std::array<uint64_t, 3>{blocks, kBlock, bytes % kBlock} || blocks > file.size() / sizeof(uint64_t)) {
    return file.Bad("has blocks that are not read");
  }
  std::vector<uint64_t> packed(blocks);
  if (auto status = file.Read(packed.data(), blocks * sizeof(uint64_t)); !status.ok()) return status;
  uint64_t count = 0;
  std::string from, to(kBlock, '\0');
  for (uint64_t n = 0; n < blocks; ++n) {
    if (packed[n] > compressBound(kBlock)) return file.Bad("has a block that is too long");
    from.resize(packed[n]);
    if (auto status = file.Read(from.data(), from.size()); !status.ok()) return status;
    const uint64_t wanted = std::min(kBlock, bytes - n * kBlock);
    uLongf size = kBlock;
    if (uncompress(reinterpret_cast<Bytef*>(to.data()), &size, reinterpret_cast<const Bytef*>(from.data()),
                   from.size()) != Z_OK ||
        size != wanted) {
      return file.Bad("has a damaged block");
    }
    count += wanted - static_cast<uint64_t>(std::count(to.begin(), to.begin() + static_cast<int64_t>(wanted), '\0'));
  }
  return count;
}

absl::Status CheckTail(FileSource& file) {
  const absl::string_view tail = "\n</AppendedData>\n</VTKFile>\n";
  if (file.size() - file.at() < tail.size()) return file.Bad("is cut short");
  std::string last(tail.size(), '\0');
  if (auto status = file.Skip(file.size() - file.at() - tail.size()); !status.ok()) return status;
  if (auto status = file.Read(last.data(), last.size()); !status.ok()) return status;
  return last == tail ? absl::OkStatus() : file.Bad("is cut short");
}

}  // namespace

absl::StatusOr<Json> VtiFacts(FileSource& file) {
  const auto head = ReadHead(file, "ImageData");
  if (!head.ok()) return head.status();
  std::array<double, 6> extent{};
  std::array<double, 3> corner{}, cell{};
  std::array<uint64_t, 3> shape{};
  bool good = ReadAttribute(Attribute(head->kind, "WholeExtent"), extent) &&
              ReadAttribute(Attribute(head->kind, "Origin"), corner) &&
              ReadAttribute(Attribute(head->kind, "Spacing"), cell);
  for (size_t m = 0; m < 3; ++m) {
    constexpr double kMost = 1 << 20;
    good = good && extent[2 * m] == 0 && extent[2 * m + 1] >= 1 && extent[2 * m + 1] <= kMost;
    if (good) shape[m] = static_cast<uint64_t>(extent[2 * m + 1]);
  }
  if (!good || !head->arrays.contains("data")) return file.Bad("has no box of voxels");
  const auto voxels = CountBytes(file, shape[0] * shape[1] * shape[2]);
  if (!voxels.ok()) return voxels.status();
  if (auto status = CheckTail(file); !status.ok()) return status;
  return Json{{"voxels", *voxels}, {"shape", shape}, {"low_corner", corner}, {"cell", cell}, {"arrays", head->arrays}};
}

absl::StatusOr<Json> VtuFacts(FileSource& file) {
  const auto head = ReadHead(file, "UnstructuredGrid");
  if (!head.ok()) return head.status();
  uint64_t voxels = 0;
  if (!absl::SimpleAtoi(Attribute(head->piece, "NumberOfCells"), &voxels)) return file.Bad("has no number of cells");
  if (auto status = CheckTail(file); !status.ok()) return status;
  return Json{{"voxels", voxels}, {"arrays", head->arrays}};
}

}  // namespace latvox::client
