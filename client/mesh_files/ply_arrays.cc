#include "client/mesh_files/ply_arrays.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace latvox::client {
namespace {

size_t BytesOf(PlyScalar type) {
  switch (type) {
    case PlyScalar::kInt8:
    case PlyScalar::kUint8:
      return 1;
    case PlyScalar::kInt16:
    case PlyScalar::kUint16:
      return 2;
    case PlyScalar::kInt32:
    case PlyScalar::kUint32:
    case PlyScalar::kFloat32:
      return 4;
    case PlyScalar::kFloat64:
      break;
  }
  return 8;
}

// Where the bytes of a vertex have its coordinates.
struct VertexLayout {
  std::array<size_t, 3> at{};
  std::array<PlyScalar, 3> types{};
  size_t bytes = 0;  // of a vertex

  bool AllAre(PlyScalar type) const {
    return std::ranges::all_of(types, [type](PlyScalar each) { return each == type; });
  }
};

template <class T>
void AppendVertices(const VertexLayout& layout, const char* bytes, uint64_t count, std::vector<Vec3d>& positions) {
  positions.resize(positions.size() + count);
  for (auto to = positions.end() - static_cast<std::ptrdiff_t>(count); to != positions.end(); ++to) {
    for (size_t m = 0; m < 3; ++m) {
      T coordinate;
      std::memcpy(&coordinate, bytes + layout.at[m], sizeof(T));
      (*to)[m] = coordinate;
    }
    bytes += layout.bytes;
  }
}

}  // namespace

uint64_t ReadVertexArray(const PlyElement& element, PlyBody& body, Mesh& mesh) {
  VertexLayout layout;
  for (const PlyProperty& property : element.properties) {
    if (property.count_type) return 0;
    if (const auto axis = PositionOf(property, kPlyAxes)) {
      layout.at[*axis] = layout.bytes;
      layout.types[*axis] = property.type;
    }
    layout.bytes += BytesOf(property.type);
  }
  const absl::string_view bytes = body.little_endian();
  const uint64_t count = std::min<uint64_t>(element.count, bytes.size() / layout.bytes);
  if (layout.AllAre(PlyScalar::kFloat32)) {
    AppendVertices<float>(layout, bytes.data(), count, mesh.positions);
  } else if (layout.AllAre(PlyScalar::kFloat64)) {
    AppendVertices<double>(layout, bytes.data(), count, mesh.positions);
  } else {
    return 0;
  }
  body.Skip(count * layout.bytes);
  return count;
}

bool IsTriangleArray(const PlyElement& element) {
  if (element.properties.size() != 1) return false;
  const PlyProperty& list = element.properties[0];
  return (list.count_type == PlyScalar::kUint8 || list.count_type == PlyScalar::kInt8) &&
         (list.type == PlyScalar::kInt32 || list.type == PlyScalar::kUint32);
}

uint64_t ReadTriangleArray(const PlyElement& element, uint64_t count, PlyBody& body, Mesh& mesh) {
  using Triangle = std::array<uint32_t, 3>;
  constexpr size_t kBytes = 1 + sizeof(Triangle);
  const absl::string_view bytes = body.little_endian();
  const uint64_t most = std::min<uint64_t>(count, bytes.size() / kBytes);
  if (mesh.triangles.empty()) mesh.triangles.reserve(most);
  // A negative index is above all others.
  constexpr size_t kNegative = size_t{1} << 31;
  const bool is_signed = element.properties[0].type == PlyScalar::kInt32;
  const size_t limit = is_signed ? std::min(mesh.positions.size(), kNegative) : mesh.positions.size();
  uint64_t found = 0;
  for (const char* face = bytes.data(); found < most && *face == 3; ++found, face += kBytes) {
    Triangle triangle;
    std::memcpy(triangle.data(), face + 1, sizeof(Triangle));
    if (std::max({triangle[0], triangle[1], triangle[2]}) >= limit) break;
    mesh.triangles.push_back(triangle);
  }
  body.Skip(found * kBytes);
  return found;
}

}  // namespace latvox::client
