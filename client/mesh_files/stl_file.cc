#include "client/mesh_files/stl_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/stl_text.h"

// No assimp: its decimal parser misses the nearest number, and its errors name no line.
namespace latvox::client {
namespace {

constexpr size_t kHead = 84, kTriangle = 50, kNormal = 12;
constexpr Color kUncolored{255, 255, 255};
constexpr uint32_t kMostTriangles = UINT32_MAX / 3;

uint32_t DeclaredTriangles(absl::string_view bytes) {
  uint32_t triangles;
  std::memcpy(&triangles, bytes.data() + 80, sizeof(triangles));
  return triangles;
}

// Returns the bytes of the solid at the front, by its count.
uint64_t Length(absl::string_view bytes) { return kHead + kTriangle * uint64_t{DeclaredTriangles(bytes)}; }

// Returns whether the bytes are whole solids, each with triangles.
bool AreSolids(absl::string_view bytes) {
  while (bytes.size() > kHead && Length(bytes) > kHead && Length(bytes) <= bytes.size()) {
    bytes.remove_prefix(Length(bytes));
  }
  return bytes.empty();
}

// The colors of binary files have no specification. These are Materialise Magics' ones, which Autodesk's programs
// write, too: the header marks them. VisCAM's ones are in the same bits in another order, without a mark.
std::optional<Color> ColorOfSolid(absl::string_view bytes) {
  constexpr absl::string_view kMark = "COLOR=";
  const absl::string_view header = bytes.substr(0, kHead - 4);
  const size_t at = header.find(kMark);
  if (at == absl::string_view::npos || at + kMark.size() + 4 > header.size()) return std::nullopt;
  Color color;
  std::memcpy(color.data(), header.data() + at + kMark.size(), color.size());
  return color;
}

// Returns the triangle's own color, or that of its solid.
Color ColorOfTriangle(absl::string_view triangle, const Color& of_solid) {
  uint16_t bits;
  std::memcpy(&bits, triangle.data() + kTriangle - sizeof(bits), sizeof(bits));
  if ((bits & 0x8000) != 0) return of_solid;
  const auto byte = [&](unsigned shift) { return static_cast<uint8_t>((((bits >> shift) & 31U) * 255 + 15) / 31); };
  return {byte(0), byte(5), byte(10)};
}

// Appends triangle t, or reports it to `bad`.
absl::Status ReadTriangle(absl::string_view bytes, uint64_t t, BadElements& bad, Mesh& mesh) {
  std::array<std::array<float, 3>, 3> corners;
  std::memcpy(corners.data(), bytes.data() + kNormal, sizeof(corners));
  for (const auto& [x, y, z] : corners) {
    if (IsFinite({x, y, z})) continue;
    const float coordinate = !std::isfinite(x) ? x : !std::isfinite(y) ? y : z;
    return bad.Add(Bad("a vertex of triangle ", t, " is not finite (", coordinate, ")"), absl::StrCat("triangle ", t));
  }
  const auto next = static_cast<uint32_t>(mesh.positions.size());
  for (const auto& [x, y, z] : corners) mesh.positions.push_back({x, y, z});
  mesh.triangles.push_back({next, next + 1, next + 2});
  return absl::OkStatus();
}

// Reads the triangles of one solid. Those of the file are counted on from `before`.
absl::Status ReadSolid(absl::string_view bytes, uint64_t triangles, uint64_t before, BadElements& bad, Mesh& mesh) {
  if (before + triangles > kMostTriangles) return Bad(before + triangles, " triangles exceed ", kMostTriangles);
  const auto color = ColorOfSolid(bytes);
  if (color) mesh.colors.resize(mesh.positions.size(), kUncolored);
  for (uint64_t t = 0; t < triangles; ++t) {
    const absl::string_view rest = bytes.substr(std::min<uint64_t>(bytes.size(), kHead + kTriangle * t));
    if (rest.size() < kTriangle) return Bad("ends within triangle ", t, " of ", triangles);
    if (auto status = ReadTriangle(rest, before + t, bad, mesh); !status.ok()) return status;
    if (color) mesh.colors.resize(mesh.positions.size(), ColorOfTriangle(rest, *color));
  }
  return absl::OkStatus();
}

// Returns the triangles of a file whose writer did not know their number when it wrote the count.
std::optional<uint64_t> StreamedTriangles(absl::string_view bytes) {
  const uint32_t declared = DeclaredTriangles(bytes);
  const size_t size = bytes.size() - kHead;
  if ((declared != 0 && declared != UINT32_MAX) || size == 0 || size % kTriangle != 0) return std::nullopt;
  return size / kTriangle;
}

absl::StatusOr<Mesh> ParseBinary(absl::string_view bytes, const ParseOptions& options) {
  if (bytes.size() < kHead)
    return Bad("is not an STL file: neither text with \"solid\" and \"facet\", nor 84 bytes long");
  Mesh mesh;
  BadElements bad(options);
  uint64_t before = 0;
  if (const auto streamed = StreamedTriangles(bytes)) {
    mesh.warnings.push_back({"NO_COUNT", absl::StrCat("the count of triangles is ", DeclaredTriangles(bytes),
                                                      "; by the length, there are ", *streamed)});
    if (auto status = ReadSolid(bytes, *streamed, 0, bad, mesh); !status.ok()) return status;
    bytes = "";
  }
  size_t solids = 0, bare = 0;
  for (; solids == 0 ? !bytes.empty() : !bytes.empty() && AreSolids(bytes); ++solids) {
    const uint64_t triangles = DeclaredTriangles(bytes);
    if (!ColorOfSolid(bytes)) bare += triangles;
    if (solids > 0) BeginStretch(NextPart(mesh), std::nullopt, mesh);
    if (auto status = ReadSolid(bytes, triangles, before, bad, mesh); !status.ok()) return status;
    before += triangles;
    bytes.remove_prefix(Length(bytes));
  }
  if (solids > 1) {
    mesh.warnings.push_back({"SEVERAL_SOLIDS", absl::StrCat("contains ", solids, " binary solids; all are read")});
  }
  if (!bytes.empty()) {
    mesh.warnings.push_back({"TRAILING_DATA", absl::StrCat(bytes.size(), " bytes after the triangles are ignored")});
  }
  if (!mesh.colors.empty() && bare > 0) {
    mesh.colors.resize(mesh.positions.size(), kUncolored);
    mesh.warnings.push_back(
        {"PARTIAL_COLORS", absl::StrCat(bare, " of ", before, " triangles have no color, and are white")});
  }
  bad.Report(mesh);
  return mesh;
}

// Returns the text without zero bytes at its end, or nothing if the bytes are binary. The length alone does not tell:
// binary files may be cut short or have trailing bytes. The beginning does not either: headers of binary files often
// begin with "solid".
std::optional<absl::string_view> StlTextOf(absl::string_view bytes) {
  const absl::string_view head = absl::StripLeadingAsciiWhitespace(bytes.substr(0, 1024));
  if (IsBinaryStl(bytes) || !absl::StartsWithIgnoreCase(head, "solid")) return std::nullopt;
  const absl::string_view text = bytes.substr(0, bytes.find('\0'));
  const bool has_zeros = text.size() < bytes.size();
  const std::string lower = absl::AsciiStrToLower(text.substr(0, 1 << 16));
  if (has_zeros && !absl::StrContains(lower, "endloop")) return std::nullopt;  // the header of a binary file
  if (!absl::StrContains(lower, "facet") && !absl::StrContains(lower, "endsolid")) return std::nullopt;
  return text;
}

}  // namespace

bool IsBinaryStl(absl::string_view bytes) { return bytes.size() >= kHead && bytes.size() == Length(bytes); }

absl::StatusOr<Mesh> ParseStl(absl::string_view bytes, const ParseOptions& options) {
  const auto text = StlTextOf(bytes);
  if (!text) return ParseBinary(bytes, options);
  auto mesh = ParseStlText(*text, options);
  if (mesh.ok() && text->size() < bytes.size()) {
    mesh->warnings.push_back(
        {"TRAILING_DATA", absl::StrCat(bytes.size() - text->size(), " bytes from the first zero byte on are ignored")});
  }
  return mesh;
}

}  // namespace latvox::client
