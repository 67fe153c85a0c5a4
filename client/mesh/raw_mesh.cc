#include "client/mesh/raw_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh/mesh_encoder.h"

namespace latvox::client {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr size_t kMostAttributes = 3;

template <class T>
void Append(const std::vector<T>& values, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

// The vertices of the arrays: for each the vertex of the mesh, and the numbers that it carries.
struct Vertices {
  std::vector<uint32_t> of_mesh;
  std::vector<std::array<uint32_t, kMostAttributes>> numbers;
  std::vector<std::array<uint32_t, 3>> triangles;
};

Vertices Split(const Mesh& mesh, const std::vector<Field>& attributes) {
  using Key = std::pair<uint32_t, std::array<uint32_t, kMostAttributes>>;
  absl::flat_hash_map<Key, uint32_t> vertex_of;
  AttributeNumbers numbers(mesh);
  Vertices out;
  out.triangles = mesh.triangles;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (uint32_t& vertex : out.triangles[t]) {
      Key key{vertex, {}};
      for (size_t a = 0; a < attributes.size(); ++a) key.second[a] = numbers.At(t, vertex, attributes[a]);
      const auto [found, is_new] = vertex_of.try_emplace(key, static_cast<uint32_t>(out.of_mesh.size()));
      if (is_new) {
        out.of_mesh.push_back(key.first);
        out.numbers.push_back(key.second);
      }
      vertex = found->second;
    }
  }
  return out;
}

template <class Number>
void AppendPositions(const std::vector<Vec3d>& positions, std::string& bytes) {
  std::vector<std::array<Number, 3>> numbers;
  numbers.reserve(positions.size());
  for (const auto& [x, y, z] : positions) {
    numbers.push_back({static_cast<Number>(x), static_cast<Number>(y), static_cast<Number>(z)});
  }
  Append(numbers, bytes);
}

}  // namespace

bool FitsFloat32(const Mesh& mesh) {
  return std::all_of(mesh.positions.begin(), mesh.positions.end(), [](const Vec3d& position) {
    return std::all_of(position.begin(), position.end(), [](double x) { return double{static_cast<float>(x)} == x; });
  });
}

RawMesh ToRaw(const Mesh& mesh, const std::vector<Field>& attributes) {
  Vertices split;
  if (!attributes.empty()) split = Split(mesh, attributes);
  std::vector<Vec3d> moved;
  for (const uint32_t vertex : split.of_mesh) moved.push_back(mesh.positions[vertex]);
  const std::vector<Vec3d>& positions = attributes.empty() ? mesh.positions : moved;
  const auto& triangles = attributes.empty() ? mesh.triangles : split.triangles;
  RawMesh raw{{positions.size(), triangles.size(), !FitsFloat32(mesh), attributes}, {}};
  raw.layout.has_doubles ? AppendPositions<double>(positions, raw.bytes) : AppendPositions<float>(positions, raw.bytes);
  Append(triangles, raw.bytes);
  for (size_t a = 0; a < attributes.size(); ++a) {
    std::vector<uint32_t> numbers;
    for (const auto& of_vertex : split.numbers) numbers.push_back(of_vertex[a]);
    Append(numbers, raw.bytes);
  }
  return raw;
}

uint64_t MostRawBytes(const Mesh& mesh, const std::vector<Field>& attributes) {
  const uint64_t triangles = mesh.triangles.size();
  // Each corner may carry its own numbers.
  const uint64_t vertices = attributes.empty() ? mesh.positions.size() : 3 * triangles;
  const uint64_t of_position = 3 * (FitsFloat32(mesh) ? sizeof(float) : sizeof(double));
  return vertices * (of_position + attributes.size() * sizeof(uint32_t)) + triangles * 3 * sizeof(uint32_t);
}

bool NeedsDoubles(const Mesh& mesh, int quantization_bits) {
  if (FitsFloat32(mesh)) return false;
  if (quantization_bits == 0) return true;
  double farthest = 0;
  for (const auto& triangle : mesh.triangles) {
    for (const uint32_t vertex : triangle) {
      for (const double x : mesh.positions[vertex]) farthest = std::max(farthest, std::abs(x));
    }
  }
  constexpr int kFloatBits = 24;
  return std::ldexp(farthest, -kFloatBits) > std::ldexp(LongestSide(mesh), -quantization_bits - 1);
}

std::optional<Warning> WarningOfRounding(const Mesh& mesh, int quantization_bits) {
  if (!NeedsDoubles(mesh, quantization_bits)) return std::nullopt;
  return Warning{"POSITIONS_ROUNDED", "Draco rounds the positions to 32 bits, which are coarse so far from 0",
                 "positions"};
}

}  // namespace latvox::client
