#include "client/tool/inspect/table_facts.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "client/mesh_files/ply_header.h"
#include "client/tool/inspect/extent.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

// Reads the numbers at the front of a line with commas between them. Returns false if there are fewer.
template <class Number, size_t kCount>
bool ReadNumbers(absl::string_view& line, std::array<Number, kCount>& numbers) {
  for (Number& number : numbers) {
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc()) return false;
    line.remove_prefix(static_cast<size_t>(end - line.data()));
    if (!line.empty() && line[0] != ',') return false;
    if (!line.empty()) line.remove_prefix(1);
  }
  return true;
}

// Reads the rows of a table of voxels (3) or pixels (2).
template <size_t kDimension>
absl::StatusOr<Json> CsvRows(FileSource& file, const std::string& header) {
  Extent<int32_t, kDimension> box;
  Extent<double, kDimension> bounds;
  uint64_t rows = 0;
  for (std::string line;;) {
    const auto more = file.ReadLine(line);
    if (!more.ok()) return more.status();
    if (!*more) break;
    absl::string_view rest = line;
    std::array<int32_t, kDimension> index;
    std::array<double, kDimension> world;
    if (!ReadNumbers(rest, index) || !ReadNumbers(rest, world)) {
      return file.Bad("line ", rows + 2, " does not begin with ", 2 * kDimension, " numbers");
    }
    box.Add(index);
    bounds.Add(world);
    ++rows;
  }
  const std::vector<std::string> columns = absl::StrSplit(header, ',');
  return Json{{"columns", columns},
              {kDimension == 3 ? "voxels" : "pixels", rows},
              {"index_box", box.ToJson(1)},
              {"bounds", bounds.ToJson()}};
}

// Reads the rows of a table of links.
absl::StatusOr<Json> LinkRows(FileSource& file, const std::string& header) {
  Extent<int32_t> box;
  uint64_t rows = 0;
  for (std::string line;; ++rows) {
    const auto more = file.ReadLine(line);
    if (!more.ok()) return more.status();
    if (!*more) break;
    absl::string_view rest = line;
    Vec3i ijk, neighbor;
    if (!ReadNumbers(rest, ijk) || !ReadNumbers(rest, neighbor)) {
      return file.Bad("line ", rows + 2, " does not begin with 6 integers");
    }
    box.Add(ijk);
  }
  const std::vector<std::string> columns = absl::StrSplit(header, ',');
  return Json{{"columns", columns}, {"links", rows}, {"index_box", box.ToJson(1)}};
}

size_t BytesOf(PlyScalar scalar) {
  constexpr size_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<size_t>(scalar)];
}

// The rows of a .ply of voxel centers.
struct PlyRows {
  uint64_t count = 0;
  size_t bytes = 0;  // of each; 0: the file holds anything else
  std::vector<std::string> columns;
};

// Returns the bytes of a row if the header is that of voxel centers, otherwise 0.
size_t RowOf(const PlyHeader& header) {
  constexpr std::pair<const char*, PlyScalar> kFirst[] = {{"x", PlyScalar::kFloat64}, {"y", PlyScalar::kFloat64},
                                                          {"z", PlyScalar::kFloat64}, {"i", PlyScalar::kInt32},
                                                          {"j", PlyScalar::kInt32},   {"k", PlyScalar::kInt32}};
  if (header.format != PlyFormat::kLittleEndian || header.elements.size() != 1) return 0;
  const std::vector<PlyProperty>& properties = header.elements[0].properties;
  const auto same = [](const auto& first, const PlyProperty& property) {
    return first.first == property.name && first.second == property.type && !property.count_type;
  };
  if (properties.size() < std::size(kFirst) ||
      !std::equal(std::begin(kFirst), std::end(kFirst), properties.begin(), same))
    return 0;
  size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    if (property.count_type) return 0;
    bytes += BytesOf(property.type);
  }
  return bytes;
}

// Reads to the end of the header.
absl::StatusOr<PlyRows> ReadPlyHead(FileSource& file) {
  constexpr uint64_t kMostHeader = uint64_t{1} << 16;
  std::string head, line;
  while (line != "end_header" && file.at() < kMostHeader) {
    const auto more = file.ReadLine(line);
    if (!more.ok()) return more.status();
    if (!*more) break;
    absl::StrAppend(&head, line, "\n");
  }
  absl::string_view rest = head;
  const auto header = ReadPlyHeader(rest);
  if (!header.ok()) return file.Bad(header.status().message());
  PlyRows rows;
  rows.bytes = RowOf(*header);
  if (rows.bytes == 0) return rows;
  rows.count = header->elements[0].count;
  for (const PlyProperty& property : header->elements[0].properties) rows.columns.push_back(property.name);
  return rows;
}

}  // namespace

absl::StatusOr<Json> CsvFacts(FileSource& file) {
  std::string header;
  if (const auto more = file.ReadLine(header); !more.ok()) return more.status();
  const std::string whole = header + ",";
  if (absl::StartsWith(whole, "i,j,k,x,y,z,")) return CsvRows<3>(file, header);
  if (absl::StartsWith(whole, "i,j,k,di,dj,dk,")) return LinkRows(file, header);
  if (absl::StartsWith(whole, "i,j,x,y,")) return CsvRows<2>(file, header);
  return file.Bad("does not begin with i,j,k,x,y,z or i,j,k,di,dj,dk or i,j,x,y, as the files of latvox do");
}

absl::StatusOr<std::optional<Json>> PlyFacts(FileSource& file) {
  const auto row = ReadPlyHead(file);
  if (!row.ok()) return row.status();
  if (row->bytes == 0) return std::nullopt;
  const uint64_t left = file.size() - file.at();
  if (row->count > left / row->bytes || row->count * row->bytes != left) {
    return file.Bad("has ", left, " bytes of points, not ", row->count, " x ", row->bytes);
  }
  Extent<int32_t> box;
  Extent<double> bounds;
  std::string bytes(row->bytes, '\0');
  for (uint64_t n = 0; n < row->count; ++n) {
    if (auto status = file.Read(bytes.data(), bytes.size()); !status.ok()) return status;
    Vec3d world;
    Vec3i ijk;
    std::memcpy(world.data(), bytes.data(), sizeof(world));
    std::memcpy(ijk.data(), bytes.data() + sizeof(world), sizeof(ijk));
    bounds.Add(world);
    box.Add(ijk);
  }
  return Json{
      {"columns", row->columns}, {"voxels", row->count}, {"index_box", box.ToJson(1)}, {"bounds", bounds.ToJson()}};
}

}  // namespace latvox::client
