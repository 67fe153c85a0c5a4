#include "client/mesh_files/gltf_primitive.h"

#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/draco_file.h"
#include "client/mesh_files/gltf_accessor.h"

namespace latvox::client {
namespace {

enum Mode : uint64_t { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kStrip, kFan };

// Returns the number of points or lines with this number of corners.
uint64_t PointsOrLines(Mode mode, uint64_t corners) {
  if (mode == kLines) return corners / 2;
  return mode == kLineStrip && corners > 0 ? corners - 1 : corners;
}

// Returns the corners of triangle t. All triangles have one orientation.
std::array<size_t, 3> CornersOf(Mode mode, size_t t) {
  if (mode == kTriangles) return {3 * t, 3 * t + 1, 3 * t + 2};
  if (mode == kFan) return {t + 1, t + 2, 0};
  return {t, t + 1 + t % 2, t + 2 - t % 2};
}

absl::Status AppendTriangles(Mode mode, const std::vector<uint32_t>& corners, Mesh& mesh) {
  const size_t count = corners.size();
  if (mode == kTriangles && count % 3 != 0) {
    return Bad(count, " corners of triangles are not a multiple of 3");
  }
  const size_t triangles = mode == kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
  for (size_t t = 0; t < triangles; ++t) {
    auto& triangle = mesh.triangles.emplace_back();
    for (size_t n = 0; n < 3; ++n) {
      triangle[n] = corners[CornersOf(mode, t)[n]];
      if (triangle[n] < mesh.positions.size()) continue;
      return Bad("vertex index ", triangle[n], " of triangle ", t, " is not within the ", mesh.positions.size(),
                 " vertices");
    }
  }
  return absl::OkStatus();
}

absl::Status StorePositions(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers, Mesh& mesh) {
  const auto positions = ReadGltfFloats(accessor, root, buffers);
  if (!positions.ok()) return positions.status();
  if (positions->components != 3) return Bad("POSITION has ", positions->components, " components, not 3");
  mesh.positions.resize(positions->values.size() / 3);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    for (size_t n = 0; n < 3; ++n) mesh.positions[v][n] = positions->values[3 * v + n];
  }
  return absl::OkStatus();
}

absl::Status StoreColors(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers, Mesh& mesh) {
  const auto colors = ReadGltfFloats(accessor, root, buffers);
  if (!colors.ok()) return colors.status();
  const size_t components = colors->components, count = colors->values.size() / components;
  if (components < 3 || count != mesh.positions.size()) {
    return Bad("COLOR_0 has ", count, " elements of ", components, " components, not ", mesh.positions.size(),
               " of 3 or 4");
  }
  for (size_t v = 0; v < count; ++v) mesh.colors.push_back(ToColor(&colors->values[components * v]));
  return absl::OkStatus();
}

absl::StatusOr<Mesh> ReadDraco(const SortedJson& extension, GltfBuffers& buffers) {
  const SortedJson& attributes = extension.at("attributes");
  const auto bytes = buffers.View(extension);
  const auto positions = GltfNumber(attributes, "POSITION"), colors = GltfNumber(attributes, "COLOR_0", 0);
  if (!bytes.ok()) return bytes.status();
  for (const auto* field : {&positions, &colors}) {
    if (!field->ok()) return field->status();
  }
  DracoIds ids{.positions = static_cast<uint32_t>(*positions)};
  if (attributes.contains("COLOR_0")) ids.colors = static_cast<uint32_t>(*colors);
  auto mesh = ParseDraco(*bytes, ids);
  if (!mesh.ok()) {
    return absl::Status(mesh.status().code(), absl::StrCat("KHR_draco_mesh_compression: ", mesh.status().message()));
  }
  return mesh;
}

absl::StatusOr<Mesh> ReadTriangles(Mode mode, const SortedJson& primitive, const SortedJson& root,
                                   GltfBuffers& buffers) {
  const SortedJson& attributes = primitive.at("attributes");
  const auto position = GltfIndex(attributes, "POSITION", root, "accessors");
  if (!position.ok()) return position.status();
  Mesh mesh;
  if (auto status = StorePositions(*position, root, buffers, mesh); !status.ok()) return status;
  if (attributes.contains("COLOR_0")) {
    const auto color = GltfIndex(attributes, "COLOR_0", root, "accessors");
    if (!color.ok()) return color.status();
    if (auto status = StoreColors(*color, root, buffers, mesh); !status.ok()) return status;
  }
  std::vector<uint32_t> corners(mesh.positions.size());
  std::iota(corners.begin(), corners.end(), 0);
  if (primitive.contains("indices")) {
    const auto number = GltfIndex(primitive, "indices", root, "accessors");
    if (!number.ok()) return number.status();
    auto indices = ReadGltfIndices(*number, root, buffers);
    if (!indices.ok()) return indices.status();
    corners = *std::move(indices);
  }
  if (auto status = AppendTriangles(mode, corners, mesh); !status.ok()) return status;
  return mesh;
}

// Counts points or lines without reading their coordinates.
absl::StatusOr<Mesh> CountPointsOrLines(Mode mode, const SortedJson& primitive, const SortedJson& root) {
  const bool indexed = primitive.contains("indices");
  const SortedJson& named = indexed ? primitive : primitive.at("attributes");
  const auto number = GltfIndex(named, indexed ? "indices" : "POSITION", root, "accessors");
  if (!number.ok()) return number.status();
  const auto count = GltfNumber(root.at("accessors").at(*number), "count");
  if (!count.ok()) return Bad("accessors[", *number, "]: ", count.status().message());
  Mesh mesh;
  mesh.skipped = PointsOrLines(mode, *count);
  return mesh;
}

}  // namespace

absl::StatusOr<Mesh> ReadGltfPrimitive(const SortedJson& primitive, const SortedJson& root, GltfBuffers& buffers) {
  const auto number = GltfNumber(primitive, "mode", kTriangles);
  if (!number.ok()) return number.status();
  if (*number > kFan) return Bad("mode ", *number, " exceeds ", +kFan);
  const Mode mode{*number};
  if (!primitive.at("attributes").contains("POSITION")) return Mesh();
  if (mode < kTriangles) return CountPointsOrLines(mode, primitive, root);
  const SortedJson extensions = primitive.value("extensions", SortedJson::object());
  const auto draco = extensions.find("KHR_draco_mesh_compression");
  return draco == extensions.end() ? ReadTriangles(mode, primitive, root, buffers) : ReadDraco(*draco, buffers);
}

}  // namespace latvox::client
