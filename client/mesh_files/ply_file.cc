#include "client/mesh_files/ply_file.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/indexed_faces.h"
#include "client/mesh_files/ply_arrays.h"
#include "client/mesh_files/ply_body.h"
#include "client/mesh_files/ply_color.h"
#include "client/mesh_files/ply_header.h"
#include "client/mesh_files/triangle_colors.h"

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

absl::Status ReadVertices(const PlyElement& element, PlyBody& body, Mesh& mesh) {
  if (const char* axis = Missing(element, kPlyAxes)) return Bad("PLY header: element vertex has no property ", axis);
  PlyColors colors(element);
  std::vector<std::optional<size_t>> axes;  // of each property
  for (const PlyProperty& property : element.properties) axes.push_back(PositionOf(property, kPlyAxes));
  for (uint64_t n = colors.exist() ? 0 : ReadVertexArray(element, body, mesh); n < element.count; ++n) {
    body.BeginElement();
    Vec3d position{};
    for (size_t p = 0; p < axes.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (axes[p]) {
        position[*axes[p]] = body.ReadNumber(property.type);
      } else if (!colors.Read(property, n, body)) {
        SkipProperty(property, body);
      }
    }
    if (!body.ok()) return EndsEarly(element, n, body);
    body.EndElement();
    mesh.positions.push_back(position);
    if (colors.exist() && colors.fault().empty()) mesh.colors.push_back(colors.color());
  }
  if (mesh.no_color.empty()) mesh.no_color = colors.fault();
  return absl::OkStatus();
}

bool IsCorners(const PlyProperty& property) {
  return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void ReadIndices(const PlyProperty& property, PlyBody& body, std::vector<double>& indices) {
  indices.clear();
  for (double count = body.ReadNumber(*property.count_type); body.ok() && count >= 1; --count) {
    indices.push_back(body.ReadNumber(property.type));
  }
}

// The colors of faces, one for each triangle.
struct FaceColors {
  std::vector<std::optional<Color>> of_triangles = {};
  std::string fault = {};  // the reason why they are no colors
};

// Finishes face n of the element.
absl::Status FinishFace(const PlyElement& element, uint64_t n, const absl::Status& status, PlyBody& body,
                        BadElements& bad) {
  if (body.ended()) return status;
  if (!status.ok()) {
    if (auto error = bad.Add(status, absl::StrCat(element.name, " ", n)); !error.ok()) return error;
  }
  body.EndElement();
  return absl::OkStatus();
}

absl::Status ReadPlyFaces(const PlyElement& element, PlyBody& body, BadElements& bad, FaceColors& face_colors,
                          Mesh& mesh) {
  std::vector<bool> are_corners;  // of each property
  for (const PlyProperty& property : element.properties) are_corners.push_back(IsCorners(property));
  if (std::ranges::count(are_corners, true) == 0) return Bad("PLY header: element face has no list vertex_indices");
  PlyColors colors(element);
  std::vector<double> indices;
  if (colors.exist()) face_colors.of_triangles.resize(mesh.triangles.size());
  const bool is_array = IsTriangleArray(element) && std::ranges::all_of(mesh.positions, IsFinite);
  for (uint64_t n = 0; n < element.count; ++n) {
    if (is_array) n += ReadTriangleArray(element, element.count - n, body, mesh);
    if (n == element.count) break;
    body.BeginElement();
    for (size_t p = 0; p < are_corners.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (are_corners[p]) {
        ReadIndices(property, body, indices);
      } else if (!colors.Read(property, n, body)) {
        SkipProperty(property, body);
      }
    }
    const absl::Status status = body.ok() ? AppendFace(indices, n, mesh) : EndsEarly(element, n, body);
    if (auto error = FinishFace(element, n, status, body, bad); !error.ok()) return error;
    if (colors.exist()) face_colors.of_triangles.resize(mesh.triangles.size(), colors.color());
  }
  if (face_colors.fault.empty()) face_colors.fault = colors.fault();
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

// Colors of vertices count, if there are both.
void TakeFaceColors(const FaceColors& colors, Mesh& mesh) {
  if (colors.of_triangles.empty()) return;
  if (!mesh.colors.empty() || !mesh.no_color.empty()) return WarnOfFaceColors(mesh);
  mesh.no_color = colors.fault;
  if (colors.fault.empty()) ColorTriangles(colors.of_triangles, mesh);
}

}  // namespace

// No declared count is trusted with an allocation: vectors grow with the bytes that exist.
absl::StatusOr<Mesh> ParsePly(absl::string_view bytes, const ParseOptions& options) {
  const absl::StatusOr<PlyHeader> header = ReadPlyHeader(bytes);
  if (!header.ok()) return header.status();
  PlyBody body(bytes, header->format, header->lines);
  BadElements bad(options);
  FaceColors face_colors;
  Mesh mesh;
  for (const PlyElement& element : header->elements) {
    absl::Status status = element.name == "vertex"      ? ReadVertices(element, body, mesh)
                          : element.name == "face"      ? ReadPlyFaces(element, body, bad, face_colors, mesh)
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
  TakeFaceColors(face_colors, mesh);
  bad.Report(mesh);
  RemoveNotFinite(mesh);
  return mesh;
}

}  // namespace latvox::client
