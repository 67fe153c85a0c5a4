#include "client/mesh/mesh_encoder.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr int kEdgebreakerSpeed = 3;  // compression level 7: size and speed measured best
constexpr int kSequentialSpeed = 10;
// To compress attributes, Draco counts symbols in tables of 4 * 2^bits bytes: 16 MiB here, and 4 GiB at 30 bits.
constexpr int kMaxCompressedBits = 22;

using Bits3 = std::array<uint32_t, 3>;  // a position, bit by bit: float32 or quantized

// The mesh in Draco's form, of the positions that triangles use, each once.
std::unique_ptr<draco::Mesh> ToDraco(const Mesh& mesh) {
  absl::flat_hash_map<Bits3, uint32_t> point_of;
  std::vector<Vec3f> points;
  auto out = std::make_unique<draco::Mesh>();
  out->SetNumFaces(mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    draco::Mesh::Face face;
    for (size_t n = 0; n < 3; ++n) {
      const Vec3f& position = mesh.positions[mesh.triangles[t][n]];
      const auto [found, fresh] =
          point_of.try_emplace(std::bit_cast<Bits3>(position), static_cast<uint32_t>(points.size()));
      if (fresh) points.push_back(position);
      face[n] = draco::PointIndex(found->second);
    }
    out->SetFace(draco::FaceIndex(static_cast<uint32_t>(t)), face);
  }
  out->set_num_points(static_cast<uint32_t>(points.size()));
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, sizeof(Vec3f), 0);
  const int id = out->AddAttribute(attribute, /*identity_mapping=*/true, static_cast<uint32_t>(points.size()));
  out->attribute(id)->buffer()->Write(0, points.data(), points.size() * sizeof(Vec3f));
  return out;
}

Bits3 PositionBits(const draco::PointAttribute& positions, draco::PointIndex point) {
  Bits3 bits;
  positions.GetMappedValue(point, bits.data());
  return bits;
}

// A sum over all triangles of a hash of their corners, read from the smallest on: the same for two meshes, but for
// chance, exactly if they hold the same triangles, each as often and turning the same way, in whatever order.
uint64_t Fingerprint(const draco::Mesh& mesh, const draco::PointAttribute& positions) {
  uint64_t sum = 0;
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    std::array<Bits3, 3> corners;
    for (size_t n = 0; n < 3; ++n) corners[n] = PositionBits(positions, mesh.face(draco::FaceIndex(f))[n]);
    // Of all three rotations the least, which is unique even if corners coincide.
    std::array<Bits3, 3> least = corners;
    for (int turn = 0; turn < 2; ++turn) {
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      least = std::min(least, corners);
    }
    uint64_t hash = 0x9E3779B97F4A7C15;
    for (const Bits3& corner : least) {
      for (const uint32_t bits : corner) {
        hash = (hash ^ bits) * 0xFF51AFD7ED558CCD;
        hash ^= hash >> 32;
      }
    }
    sum += hash;
  }
  return sum;
}

// Whether the stream, decoded, holds the triangles of `mesh`: with the positions' bits if they were not quantized, else
// with the same quantized positions, computed here from the box and the bits that the stream declares.
bool Holds(const draco::EncoderBuffer& stream, const draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(stream.data(), stream.size());
  draco::Decoder decoder;
  decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok() || decoded.value()->num_faces() != mesh.num_faces()) return false;
  const draco::PointAttribute* theirs = decoded.value()->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  const draco::PointAttribute* ours = mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (theirs == nullptr || theirs->num_components() != 3) return false;
  draco::PointAttribute quantized;
  draco::AttributeQuantizationTransform transform;
  if (theirs->GetAttributeTransformData() != nullptr) {
    if (!transform.InitFromAttribute(*theirs)) return false;
    quantized.Init(draco::GeometryAttribute::POSITION, 3, draco::DT_UINT32, false, mesh.num_points());
    quantized.SetIdentityMapping();
    if (!transform.TransformAttribute(*ours, {}, &quantized)) return false;
    ours = &quantized;
  }
  return Fingerprint(*decoded.value(), *theirs) == Fingerprint(mesh, *ours);
}

absl::StatusOr<EncodedMesh> Encode(const draco::Mesh& mesh, int quantization_bits, bool edgebreaker) {
  draco::ExpertEncoder encoder(mesh);
  const int speed = edgebreaker ? kEdgebreakerSpeed : kSequentialSpeed;
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetUseBuiltInAttributeCompression(quantization_bits <= kMaxCompressedBits);
  if (quantization_bits > 0) {
    encoder.SetAttributeQuantization(mesh.GetNamedAttributeId(draco::GeometryAttribute::POSITION), quantization_bits);
  }
  draco::EncoderBuffer stream;
  if (const auto status = encoder.EncodeToBuffer(&stream); !status.ok()) {
    return absl::InternalError(absl::StrCat("Draco cannot encode the mesh: ", status.error_msg_string()));
  }
  if (!Holds(stream, mesh)) return absl::InternalError("Draco's encoding does not hold every triangle of the mesh");
  return EncodedMesh{std::string(stream.data(), stream.size()), quantization_bits, edgebreaker};
}

}  // namespace

// Edgebreaker streams are two to five times smaller, but leave out triangles with a vertex twice, and split what is not
// manifold. Whatever does not come back whole goes sequentially, which keeps everything.
absl::StatusOr<EncodedMesh> EncodeMesh(const Mesh& mesh, int quantization_bits) try {
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("the mesh has no triangles");
  if (!(LongestSide(mesh) <= std::numeric_limits<float>::max())) {
    return absl::InvalidArgumentError(absl::StrCat("the mesh's bounding box has a side of ", LongestSide(mesh),
                                                   ", which exceeds ", std::numeric_limits<float>::max()));
  }
  const std::unique_ptr<draco::Mesh> draco_mesh = ToDraco(mesh);
  if (auto small = Encode(*draco_mesh, quantization_bits, /*edgebreaker=*/true); small.ok()) return small;
  return Encode(*draco_mesh, quantization_bits, /*edgebreaker=*/false);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory to encode the mesh");
} catch (const std::exception& error) {
  return absl::InternalError(absl::StrCat("Draco cannot encode the mesh: ", error.what()));
}

int AutoQuantizationBits(double voxels) {
  constexpr int kSubvoxelBits = 9, kMinBits = 11;
  const double bits = std::ceil(std::log2(voxels)) + kSubvoxelBits;
  // Negated, so that NaN of a mesh or a basis without extent ends at the safe side.
  if (!(bits <= kMaxQuantizationBits)) return kMaxQuantizationBits;
  return std::max(kMinBits, static_cast<int>(bits));
}

double LongestSide(const Mesh& mesh) {
  double longest = 0;
  for (size_t m = 0; m < 3; ++m) {
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t vertex : triangle) {
        low = std::min(low, mesh.positions[vertex][m]);
        high = std::max(high, mesh.positions[vertex][m]);
      }
    }
    longest = std::max(longest, double{high} - double{low});
  }
  return longest;
}

}  // namespace latvox::client
