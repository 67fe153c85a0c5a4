#include "client/mesh_files/ply_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/ply_body.h"
#include "client/mesh_files/ply_header.h"
#include "client/mesh_files/polygon.h"

// No assimp: on a file that is cut short its PLY importer crashes or does not return, and it triangulates polygons
// before anyone could check their indices.
namespace latvox::client {
namespace {

absl::Status EndsEarly(const PlyElement& element, uint64_t at, const PlyBody& body) {
  if (body.is_text() && !body.ended()) {
    return Bad("line ", body.line(), ": ", element.name, " ", at, " of ", element.count,
               " has fewer values than the header tells, or one that is not a number");
  }
  return Bad("ends or is damaged at ", element.name, " ", at, " of ", element.count);
}

void SkipProperty(const PlyProperty& property, PlyBody& body) {
  double count = property.count_type ? body.ReadNumber(*property.count_type) : 1;
  for (; body.ok() && count >= 1; --count) body.ReadNumber(property.type);
}

using Triangle = std::array<uint32_t, 3>;
using Names = std::array<const char*, 3>;

// Returns the index of the property in the names. Lists have none.
std::optional<size_t> PositionOf(const PlyProperty& property, const Names& names) {
  const auto found = std::find(names.begin(), names.end(), property.name);
  if (property.count_type || found == names.end()) return std::nullopt;
  return static_cast<size_t>(found - names.begin());
}

constexpr Names kAxes{"x", "y", "z"};
constexpr Names kColorNames[] = {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}};

// Returns the first name without a scalar property in the element, or null if all exist.
const char* Missing(const PlyElement& element, const Names& names) {
  for (const char* name : names) {
    const auto is = [&](const PlyProperty& property) { return property.name == name && !property.count_type; };
    if (std::none_of(element.properties.begin(), element.properties.end(), is)) return name;
  }
  return nullptr;
}

const Names* ColorNamesOf(const PlyElement& element) {
  const auto are = [&](const Names& names) { return Missing(element, names) == nullptr; };
  const auto* const found = std::find_if(std::begin(kColorNames), std::end(kColorNames), are);
  return found == std::end(kColorNames) ? nullptr : found;
}

// Returns the full intensity of a color of this type, or 0 if the type has no known one.
double FullScalar(PlyScalar type) {
  switch (type) {
    case PlyScalar::kUint8:
      return 255;
    case PlyScalar::kUint16:
      return 65535;
    case PlyScalar::kFloat32:
    case PlyScalar::kFloat64:
      return 1;
    default:
      return 0;
  }
}

// Returns the color component as a byte. Returns nothing, and writes the reason to mesh.no_color, if it is not a valid
// one.
uint8_t ToColorPart(double number, const PlyProperty& property, uint64_t vertex, Mesh& mesh) {
  const double full = FullScalar(property.type);
  if (full > 0 && number >= 0 && number <= full) return static_cast<uint8_t>(std::nearbyint(number / full * 255));
  if (mesh.no_color.empty()) {
    mesh.no_color = full > 0 ? absl::StrCat(property.name, " ", number, " of vertex ", vertex, " is not within 0 and ",
                                            full, ", the range of type ", NameOf(property.type))
                             : absl::StrCat("vertices have ", property.name, " as ", NameOf(property.type),
                                            ", which is not one of uchar, ushort, float, double");
  }
  return 0;
}

absl::Status ReadVertices(const PlyElement& element, PlyBody& body, Mesh& mesh) {
  if (const char* axis = Missing(element, kAxes)) return Bad("PLY header: element vertex has no property ", axis);
  const Names* const color_names = ColorNamesOf(element);
  for (uint64_t n = 0; n < element.count; ++n) {
    body.BeginElement();
    Vec3d position{};
    Color color{};
    for (const PlyProperty& property : element.properties) {
      if (const auto axis = PositionOf(property, kAxes)) {
        position[*axis] = body.ReadNumber(property.type);
      } else if (const auto part = color_names ? PositionOf(property, *color_names) : std::nullopt) {
        color[*part] = ToColorPart(body.ReadNumber(property.type), property, n, mesh);
      } else {
        SkipProperty(property, body);
      }
    }
    if (!body.ok()) return EndsEarly(element, n, body);
    body.EndElement();
    mesh.positions.push_back(position);
    if (color_names != nullptr && mesh.no_color.empty()) mesh.colors.push_back(color);
  }
  return absl::OkStatus();
}

bool IsCorners(const PlyProperty& property) {
  return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

// Returns the vertex that element n of this kind refers to.
absl::StatusOr<uint32_t> ToVertex(double index, const char* element, uint64_t n, const std::vector<Vec3d>& positions) {
  if (!(index >= 0 && index < static_cast<double>(positions.size()) && index == std::floor(index)))
    return Bad("vertex index ", index, " of ", element, " ", n, " is not within the ", positions.size(), " vertices");
  const auto vertex = static_cast<uint32_t>(index);
  if (IsFinite(positions[vertex])) return vertex;
  return Bad("vertex ", vertex, " is not finite (", absl::StrJoin(positions[vertex], " "), "), and ", element, " ", n,
             " uses it");
}

void ReadIndices(const PlyProperty& property, PlyBody& body, std::vector<double>& indices) {
  indices.clear();
  for (double count = body.ReadNumber(*property.count_type); body.ok() && count >= 1; --count) {
    indices.push_back(body.ReadNumber(property.type));
  }
}

// Appends the triangles of face n.
absl::Status AppendFace(const std::vector<double>& indices, uint64_t n, std::vector<uint32_t>& corners, Mesh& mesh) {
  corners.clear();
  for (const double index : indices) {
    const auto vertex = ToVertex(index, "face", n, mesh.positions);
    if (!vertex.ok()) return vertex.status();
    corners.push_back(*vertex);
  }
  if (corners.size() >= 3) {
    Triangulate(corners, mesh.positions, mesh.triangles);
  } else if (mesh.skipped++ == 0) {
    mesh.warnings.push_back({"SKIPPED_ELEMENTS",
                             absl::StrCat("faces of fewer than three corners are left out; the ", "first: face ", n),
                             absl::StrCat("face ", n)});
  }
  return absl::OkStatus();
}

absl::Status ReadPlyFaces(const PlyElement& element, PlyBody& body, BadElements& bad, Mesh& mesh) {
  if (std::none_of(element.properties.begin(), element.properties.end(), IsCorners)) {
    return Bad("PLY header: element face has no list vertex_indices");
  }
  if (ColorNamesOf(element) != nullptr && mesh.colors.empty() && mesh.no_color.empty())
    mesh.no_color = "colors of faces are not read, only those of vertices";
  std::vector<double> indices;
  std::vector<uint32_t> corners;
  for (uint64_t n = 0; n < element.count; ++n) {
    body.BeginElement();
    for (const PlyProperty& property : element.properties) {
      if (IsCorners(property)) {
        ReadIndices(property, body, indices);
      } else {
        SkipProperty(property, body);
      }
    }
    absl::Status status = body.ok() ? AppendFace(indices, n, corners, mesh) : EndsEarly(element, n, body);
    if (body.ended()) return status;
    if (!status.ok()) status = bad.Add(status, absl::StrCat("face ", n));
    if (!status.ok()) return status;
    body.EndElement();
  }
  return absl::OkStatus();
}

// Reads the triangles of one list. Every vertex of a strip except the first two makes a triangle with the two before
// it; -1 ends a strip.
absl::Status ReadStripList(const PlyProperty& property, uint64_t n, PlyBody& body, Mesh& mesh) {
  std::array<uint32_t, 2> before{};
  size_t length = 0;  // of the current strip
  for (double count = body.ReadNumber(*property.count_type); body.ok() && count >= 1; --count) {
    const double index = body.ReadNumber(property.type);
    if (!body.ok()) break;
    if (index == -1) {
      length = 0;
      continue;
    }
    const auto vertex = ToVertex(index, "tristrips", n, mesh.positions);
    if (!vertex.ok()) return vertex.status();
    const auto [a, b] = before;
    // Every other triangle is turned, so that all have one orientation.
    if (length >= 2) mesh.triangles.push_back(length % 2 == 0 ? Triangle{a, b, *vertex} : Triangle{b, a, *vertex});
    before = {b, *vertex};
    ++length;
  }
  return absl::OkStatus();
}

absl::Status ReadStrips(const PlyElement& element, PlyBody& body, Mesh& mesh) {
  if (std::none_of(element.properties.begin(), element.properties.end(), IsCorners)) {
    return Bad("PLY header: element tristrips has no list vertex_indices");
  }
  for (uint64_t n = 0; n < element.count; ++n) {
    body.BeginElement();
    for (const PlyProperty& property : element.properties) {
      if (!IsCorners(property)) {
        SkipProperty(property, body);
      } else if (auto status = ReadStripList(property, n, body, mesh); !status.ok()) {
        return status;
      }
    }
    if (!body.ok()) return EndsEarly(element, n, body);
    body.EndElement();
  }
  return absl::OkStatus();
}

absl::Status SkipElement(const PlyElement& element, PlyBody& body, Mesh& mesh) {
  mesh.skipped += element.count;
  if (element.properties.empty()) return absl::OkStatus();
  for (uint64_t n = 0; n < element.count; ++n) {
    body.BeginElement();
    for (const PlyProperty& property : element.properties) SkipProperty(property, body);
    if (!body.ok()) return EndsEarly(element, n, body);
    body.EndElement();
  }
  return absl::OkStatus();
}

}  // namespace

// No declared count is trusted with an allocation: vectors grow with the bytes that exist.
absl::StatusOr<Mesh> ParsePly(absl::string_view bytes, const ParseOptions& options) {
  const absl::StatusOr<PlyHeader> header = ReadPlyHeader(bytes);
  if (!header.ok()) return header.status();
  PlyBody body(bytes, header->format, header->lines);
  BadElements bad(options);
  Mesh mesh;
  for (const PlyElement& element : header->elements) {
    absl::Status status = element.name == "vertex"      ? ReadVertices(element, body, mesh)
                          : element.name == "face"      ? ReadPlyFaces(element, body, bad, mesh)
                          : element.name == "tristrips" ? ReadStrips(element, body, mesh)
                                                        : SkipElement(element, body, mesh);
    if (!status.ok()) return status;
  }
  if (!header->unmarked.empty()) {
    mesh.warnings.push_back({"UNKNOWN_HEADER", absl::StrCat("header line \"", header->unmarked, "\" is ignored")});
  }
  if (body.longer() > 0) {
    mesh.warnings.push_back({"EXTRA_VALUES",
                             absl::StrCat(body.longer(), " lines have more values than the header tells, which are ",
                                          "ignored; the first: line ", body.first_longer()),
                             absl::StrCat("line ", body.first_longer())});
  }
  if (body.HasMore()) mesh.warnings.push_back({"TRAILING_DATA", "data after the last element are ignored"});
  bad.Report(mesh);
  RemoveNotFinite(mesh);
  return mesh;
}

}  // namespace latvox::client
