#include "server/draco_decoder.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>

#include <cmath>
#include <exception>
#include <memory>
#include <new>

#include "absl/strings/str_cat.h"
#include "server/draco_header.h"
#include "server/errors.h"

namespace latvox {
namespace {

absl::Status Corrupt(absl::string_view detail) {
  return BadMesh(absl::StrCat("truncated or corrupt Draco data (", detail, ")"));
}

// Decodes but for the dequantization of POSITION: with it done, the number of bits would be lost.
absl::StatusOr<std::unique_ptr<draco::Mesh>> RunDraco(absl::string_view bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) return Corrupt(mesh.status().error_msg_string());
  return std::move(mesh).value();
}

// Whether all values that the attribute claims to have lie in its buffer.
bool IsBacked(const draco::PointAttribute& attribute) {
  if (attribute.size() == 0 || attribute.buffer() == nullptr) return false;
  const uint64_t end = static_cast<uint64_t>(attribute.byte_offset()) +
                       static_cast<uint64_t>(attribute.byte_stride()) * attribute.size();
  return end <= attribute.buffer()->data_size();
}

// Reads one position for each point, of whatever number type the attribute has.
absl::Status ReadVertices(const draco::PointAttribute& positions, uint32_t points, std::vector<Vec3f>& out) {
  if (!IsBacked(positions)) return Corrupt("POSITION has no values");
  if (!positions.is_mapping_identity() && positions.indices_map_size() < points) return Corrupt("point map");
  out.resize(points);
  for (uint32_t p = 0; p < points; ++p) {
    const draco::AttributeValueIndex value = positions.mapped_index(draco::PointIndex(p));
    if (value.value() >= positions.size()) return Corrupt(absl::StrCat("vertex ", p, " has no position"));
    const bool converted = positions.ConvertValue<float>(value, 3, out[p].data());
    if (!converted || !std::isfinite(out[p][0]) || !std::isfinite(out[p][1]) || !std::isfinite(out[p][2])) {
      return BadMesh(absl::StrCat("vertex ", p, " is not finite"));
    }
  }
  return absl::OkStatus();
}

absl::Status ReadPositions(draco::Mesh& mesh, DecodedMesh& out) {
  const int id = mesh.GetNamedAttributeId(draco::GeometryAttribute::POSITION);
  if (id < 0) return BadMesh("no POSITION attribute");
  draco::PointAttribute* positions = mesh.attribute(id);
  if (positions->data_type() == draco::DT_BOOL) return BadMesh("POSITION holds truth values, not numbers");
  // Whole numbers stand for themselves. Draco takes this flag from the stream unchecked, as a bool of any value.
  positions->set_normalized(false);
  const int components = positions->num_components();
  if (components != 3) return BadMesh(absl::StrCat("POSITION has ", components, " components, not 3"));

  const draco::AttributeTransformData* transform = positions->GetAttributeTransformData();
  if (transform == nullptr || transform->transform_type() != draco::ATTRIBUTE_QUANTIZATION_TRANSFORM) {
    return ReadVertices(*positions, mesh.num_points(), out.mesh.vertices);
  }
  // This is the step that Draco's decoder was told to skip, by its own code: the same floats.
  draco::AttributeQuantizationTransform quantization;
  if (!IsBacked(*positions) || !quantization.InitFromAttribute(*positions)) return Corrupt("quantization");
  draco::PointAttribute dequantized;
  dequantized.Init(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, false, positions->size());
  if (!quantization.InverseTransformAttribute(*positions, &dequantized)) return Corrupt("quantization");
  if (!positions->is_mapping_identity()) {
    dequantized.SetExplicitMapping(positions->indices_map_size());
    for (uint32_t p = 0; p < positions->indices_map_size(); ++p) {
      dequantized.SetPointMapEntry(draco::PointIndex(p), positions->mapped_index(draco::PointIndex(p)));
    }
  }
  out.quantization_bits = static_cast<uint32_t>(quantization.quantization_bits());
  return ReadVertices(dequantized, mesh.num_points(), out.mesh.vertices);
}

// Draco does not promise that indices are in range.
absl::Status ReadTriangles(const draco::Mesh& mesh, TriangleMesh& out) {
  const uint32_t points = mesh.num_points();
  out.triangles.resize(mesh.num_faces());
  for (uint32_t t = 0; t < mesh.num_faces(); ++t) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(t));
    for (size_t corner = 0; corner < 3; ++corner) {
      const uint32_t vertex = face[corner].value();
      if (vertex >= points) {
        return BadMesh(absl::StrCat("triangle ", t, " refers to vertex ", vertex, " of ", points));
      }
      out.triangles[t][corner] = vertex;
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<DecodedMesh> DecodeChecked(absl::string_view bytes, const Limits& limits) {
  if (absl::Status status = CheckDracoHeader(bytes, limits); !status.ok()) return status;
  absl::StatusOr<std::unique_ptr<draco::Mesh>> mesh = RunDraco(bytes);
  if (!mesh.ok()) return mesh.status();
  draco::Mesh& draco_mesh = **mesh;
  // Decoders split points, so that the header's counts are not the last word.
  if (draco_mesh.num_faces() == 0) return BadMesh("no triangles");
  if (draco_mesh.num_faces() > limits.max_triangles) {
    return LimitExceeded("mesh.triangles", draco_mesh.num_faces(), limits.max_triangles);
  }
  if (draco_mesh.num_points() > limits.max_vertices) {
    return LimitExceeded("mesh.vertices", draco_mesh.num_points(), limits.max_vertices);
  }
  DecodedMesh out;
  if (absl::Status status = ReadPositions(draco_mesh, out); !status.ok()) return status;
  if (absl::Status status = ReadTriangles(draco_mesh, out.mesh); !status.ok()) return status;
  return out;
}

}  // namespace

absl::StatusOr<DecodedMesh> DecodeDraco(absl::string_view bytes, const Limits& limits) {
  try {
    return DecodeChecked(bytes, limits);
  } catch (const std::bad_alloc&) {
    return MakeError(absl::StatusCode::kResourceExhausted, "mesh: decoding needs more memory than there is",
                     {"OUT_OF_MEMORY", "mesh", "", ""});
  } catch (const std::exception& error) {
    return Corrupt(error.what());
  }
}

}  // namespace latvox
