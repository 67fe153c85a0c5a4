#include "tests/unit/server/meshes.h"

#include <draco/compression/encode.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace latvox {
namespace {

void AddPositions(const TriangleMesh& mesh, const DracoEncoding& encoding, draco::PointCloud& out) {
  const auto points = static_cast<uint32_t>(mesh.vertices.size());
  out.set_num_points(points);
  draco::GeometryAttribute attribute;
  attribute.Init(encoding.as_position ? draco::GeometryAttribute::POSITION : draco::GeometryAttribute::GENERIC, nullptr,
                 static_cast<int8_t>(encoding.position_components), draco::DT_FLOAT32, false,
                 static_cast<int64_t>(sizeof(float)) * encoding.position_components, 0);
  const int id = out.AddAttribute(attribute, true, points);
  for (uint32_t p = 0; p < points; ++p) {
    out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p), mesh.vertices[p].data());
  }
}

draco::Encoder MakeEncoder(const DracoEncoding& encoding) {
  draco::Encoder encoder;
  encoder.SetSpeedOptions(encoding.speed, encoding.speed);
  encoder.SetEncodingMethod(static_cast<int>(encoding.method));
  if (encoding.quantization_bits > 0) {
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, encoding.quantization_bits);
  }
  return encoder;
}

}  // namespace

TriangleMesh Sphere(int rings) {
  const int columns = 2 * rings;
  TriangleMesh mesh;
  for (int r = 0; r <= rings; ++r) {
    for (int c = 0; c < columns; ++c) {
      const double polar = std::numbers::pi * r / rings, azimuth = 2 * std::numbers::pi * c / columns;
      mesh.vertices.push_back({static_cast<float>(std::sin(polar) * std::cos(azimuth)),
                               static_cast<float>(std::sin(polar) * std::sin(azimuth)),
                               static_cast<float>(std::cos(polar))});
    }
  }
  for (int r = 0; r < rings; ++r) {
    for (int c = 0; c < columns; ++c) {
      const auto at = [&](int ring, int column) { return static_cast<uint32_t>(ring * columns + column % columns); };
      mesh.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
      mesh.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
    }
  }
  return mesh;
}

TriangleMesh FlatGrid(int n) {
  TriangleMesh mesh;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) mesh.vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0});
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const auto a = static_cast<uint32_t>(y * (n + 1) + x), c = static_cast<uint32_t>(a + n + 1);
      mesh.triangles.push_back({a, a + 1, c});
      mesh.triangles.push_back({a + 1, c + 1, c});
    }
  }
  return mesh;
}

std::string EncodeDraco(const TriangleMesh& mesh, const DracoEncoding& encoding) {
  draco::Mesh out;
  AddPositions(mesh, encoding, out);
  for (const auto& triangle : mesh.triangles) {
    draco::Mesh::Face face;
    for (size_t corner = 0; corner < 3; ++corner) face[corner] = draco::PointIndex(triangle[corner]);
    out.AddFace(face);
  }
  if (encoding.metadata) {
    auto metadata = std::make_unique<draco::GeometryMetadata>();
    metadata->AddEntryString("name", "a mesh with metadata");
    out.AddMetadata(std::move(metadata));
  }
  draco::EncoderBuffer buffer;
  if (!MakeEncoder(encoding).EncodeMeshToBuffer(out, &buffer).ok()) return "";
  return std::string(buffer.data(), buffer.size());
}

std::string EncodeDracoPointCloud(const TriangleMesh& mesh) {
  draco::PointCloud out;
  AddPositions(mesh, {}, out);
  draco::EncoderBuffer buffer;
  if (!MakeEncoder({.method = DracoMethod::kSequential}).EncodePointCloudToBuffer(out, &buffer).ok()) return "";
  return std::string(buffer.data(), buffer.size());
}

}  // namespace latvox
