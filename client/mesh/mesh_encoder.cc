#include "client/mesh/mesh_encoder.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"

namespace latvox::client {
namespace {

constexpr int kEdgebreakerSpeed = 3;  // compression level 7: the best size and speed in measurements
constexpr int kSequentialSpeed = 10;
// To compress attributes, Draco counts symbols in tables of 4 * 2^bits bytes: 16 MiB here, but 4 GiB at 30 bits.
constexpr int kMaxCompressedBits = 22;

// A corner: its position, bit by bit (float32 or quantized), and the numbers of its attributes, if there are any, in as
// many words.
constexpr size_t kPlain = 3, kCarrying = 6;
template <size_t kWords>
using Corner = std::array<uint32_t, kWords>;

// The mesh in Draco's form, with each corner of triangles once, and without attributes.
template <size_t kWords>
std::unique_ptr<draco::Mesh> ToDraco(const Mesh& mesh, const std::vector<Field>& attributes,
                                     std::vector<Corner<kWords>>& points) {
  absl::flat_hash_map<Corner<kWords>, uint32_t> point_of;
  AttributeNumbers numbers(mesh);
  auto out = std::make_unique<draco::Mesh>();
  out->SetNumFaces(mesh.triangles.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    draco::Mesh::Face face;
    for (size_t n = 0; n < 3; ++n) {
      const uint32_t vertex = mesh.triangles[t][n];
      Corner<kWords> corner{};
      const Vec3d& position = mesh.positions[vertex];
      for (size_t m = 0; m < 3; ++m) corner[m] = std::bit_cast<uint32_t>(static_cast<float>(position[m]));
      if constexpr (kWords > kPlain) {
        for (size_t a = 0; a < attributes.size(); ++a) corner[kPlain + a] = numbers.At(t, vertex, attributes[a]);
      }
      const auto [found, fresh] = point_of.try_emplace(corner, static_cast<uint32_t>(points.size()));
      if (fresh) points.push_back(corner);
      face[n] = draco::PointIndex(found->second);
    }
    out->SetFace(draco::FaceIndex(static_cast<uint32_t>(t)), face);
  }
  out->set_num_points(static_cast<uint32_t>(points.size()));
  return out;
}

// Adds an attribute with one value for each point.
draco::PointAttribute& Add(draco::GeometryAttribute::Type type, int8_t components, draco::DataType number,
                           bool normalized, draco::Mesh& mesh) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, components, number, normalized, components * draco::DataTypeLength(number), 0);
  return *mesh.attribute(mesh.AddAttribute(attribute, /*identity_mapping=*/true, mesh.num_points()));
}

template <size_t kWords>
void AddPositions(const std::vector<Corner<kWords>>& points, draco::Mesh& mesh) {
  draco::PointAttribute& positions =
      Add(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, /*normalized=*/false, mesh);
  for (uint32_t p = 0; p < points.size(); ++p) {
    positions.SetAttributeValue(draco::AttributeValueIndex(p), points[p].data());
  }
}

void AddAttribute(Field attribute, size_t word, const std::vector<Corner<kCarrying>>& points, draco::Mesh& mesh) {
  const bool is_color = attribute == Field::kColor;
  draco::PointAttribute& values =
      is_color ? Add(draco::GeometryAttribute::COLOR, 3, draco::DT_UINT8, /*normalized=*/true, mesh)
               : Add(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT32, /*normalized=*/false, mesh);
  if (!is_color) {
    auto metadata = std::make_unique<draco::AttributeMetadata>();
    metadata->AddEntryString("name", NameOf(attribute));
    mesh.AddAttributeMetadata(mesh.num_attributes() - 1, std::move(metadata));
  }
  for (uint32_t p = 0; p < points.size(); ++p) {
    const uint32_t number = points[p][word];
    const Color color{static_cast<uint8_t>(number >> 16), static_cast<uint8_t>(number >> 8),
                      static_cast<uint8_t>(number)};
    values.SetAttributeValue(draco::AttributeValueIndex(p),
                             is_color ? static_cast<const void*>(color.data()) : static_cast<const void*>(&number));
  }
}

std::unique_ptr<draco::Mesh> ToDraco(const Mesh& mesh, const std::vector<Field>& attributes) {
  if (attributes.empty()) {
    std::vector<Corner<kPlain>> points;
    auto out = ToDraco<kPlain>(mesh, attributes, points);
    AddPositions(points, *out);
    return out;
  }
  std::vector<Corner<kCarrying>> points;
  auto out = ToDraco<kCarrying>(mesh, attributes, points);
  AddPositions(points, *out);
  for (size_t a = 0; a < attributes.size(); ++a) AddAttribute(attributes[a], kPlain + a, points, *out);
  return out;
}

// The attributes of a mesh in the order of `attributes`, after its positions; fewer if some are missing or not ours.
std::vector<const draco::PointAttribute*> ValuesOf(const draco::Mesh& mesh, const std::vector<Field>& attributes) {
  std::vector<const draco::PointAttribute*> values;
  for (const Field attribute : attributes) {
    const bool is_color = attribute == Field::kColor;
    const int id = is_color ? mesh.GetNamedAttributeId(draco::GeometryAttribute::COLOR)
                            : mesh.GetAttributeIdByMetadataEntry("name", NameOf(attribute));
    if (id < 0) continue;
    const draco::PointAttribute* found = mesh.attribute(id);
    const bool same = found->data_type() == (is_color ? draco::DT_UINT8 : draco::DT_UINT32) &&
                      found->num_components() == (is_color ? 3 : 1);
    if (same) values.push_back(found);
  }
  return values;
}

template <size_t kWords>
Corner<kWords> CornerAt(const std::vector<const draco::PointAttribute*>& values, draco::PointIndex point) {
  Corner<kWords> corner{};
  values[0]->GetMappedValue(point, corner.data());
  for (size_t n = 1; n < values.size(); ++n) values[n]->GetMappedValue(point, &corner[kPlain + n - 1]);
  return corner;
}

// The sum over all triangles of a hash of their corners, read from the smallest on. It is the same for two meshes,
// except by chance, iff they have the same triangles, each as often and with the same orientation, in any order.
//   values   positions, and the corners' attributes
template <size_t kWords>
uint64_t Fingerprint(const draco::Mesh& mesh, const std::vector<const draco::PointAttribute*>& values) {
  uint64_t sum = 0;
  for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
    std::array<Corner<kWords>, 3> corners;
    for (size_t n = 0; n < 3; ++n) corners[n] = CornerAt<kWords>(values, mesh.face(draco::FaceIndex(f))[n]);
    // The smallest of the three rotations, which is unique even if corners coincide.
    std::array<Corner<kWords>, 3> least = corners;
    for (int turn = 0; turn < 2; ++turn) {
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      least = std::min(least, corners);
    }
    uint64_t hash = 0x9E3779B97F4A7C15;
    for (const Corner<kWords>& corner : least) {
      for (const uint32_t bits : corner) {
        hash = (hash ^ bits) * 0xFF51AFD7ED558CCD;
        hash ^= hash >> 32;
      }
    }
    sum += hash;
  }
  return sum;
}

// Returns whether the decoded stream has the triangles of `mesh` and their attributes. Positions have the same bits if
// they were not quantized. Quantized positions are computed here from the box and the bits that the stream declares,
// and must be the same.
bool Holds(const draco::EncoderBuffer& stream, const draco::Mesh& mesh, const std::vector<Field>& attributes) {
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
  std::vector<const draco::PointAttribute*> of_theirs = ValuesOf(*decoded.value(), attributes);
  std::vector<const draco::PointAttribute*> of_ours = ValuesOf(mesh, attributes);
  if (of_theirs.size() != attributes.size()) return false;
  of_theirs.insert(of_theirs.begin(), theirs);
  of_ours.insert(of_ours.begin(), ours);
  const auto fingerprint = attributes.empty() ? Fingerprint<kPlain> : Fingerprint<kCarrying>;
  return fingerprint(*decoded.value(), of_theirs) == fingerprint(mesh, of_ours);
}

absl::Status CheckFloat32(const Mesh& mesh) {
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    for (const double x : mesh.positions[v]) {
      if (std::isfinite(static_cast<float>(x))) continue;
      return absl::InvalidArgumentError(absl::StrCat("vertex ", v, ": ", x, " exceeds float32, Draco's numbers"));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<EncodedMesh> Encode(const draco::Mesh& mesh, int quantization_bits, const std::vector<Field>& attributes,
                                   bool edgebreaker) {
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
  if (!Holds(stream, mesh, attributes))
    return absl::InternalError("Draco's encoding does not hold every triangle of the mesh");
  return EncodedMesh{std::string(stream.data(), stream.size()), quantization_bits, edgebreaker};
}

}  // namespace

// Edgebreaker streams are two to five times smaller, but leave out triangles with a repeated vertex, and split
// non-manifold parts. A mesh that does not come back whole is encoded sequentially, which keeps everything.
absl::StatusOr<EncodedMesh> EncodeMesh(const Mesh& mesh, int quantization_bits,
                                       const std::vector<Field>& attributes) try {
  if (mesh.triangles.empty()) return absl::InvalidArgumentError("the mesh has no triangles");
  if (absl::Status status = CheckFloat32(mesh); !status.ok()) return status;
  if (!(LongestSide(mesh) <= std::numeric_limits<float>::max())) {
    return absl::InvalidArgumentError(absl::StrCat("the mesh's bounding box has a side of ", LongestSide(mesh),
                                                   ", which exceeds ", std::numeric_limits<float>::max()));
  }
  const std::unique_ptr<draco::Mesh> draco_mesh = ToDraco(mesh, attributes);
  if (auto small = Encode(*draco_mesh, quantization_bits, attributes, /*edgebreaker=*/true); small.ok()) return small;
  return Encode(*draco_mesh, quantization_bits, attributes, /*edgebreaker=*/false);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory to encode the mesh");
} catch (const std::exception& error) {
  return absl::InternalError(absl::StrCat("Draco cannot encode the mesh: ", error.what()));
}

int AutoQuantizationBits(double voxels) {
  constexpr int kSubvoxelBits = 9, kMinBits = 11;
  const double bits = std::ceil(std::log2(voxels)) + kSubvoxelBits;
  // Negated, so that NaN of a mesh or a basis without extent gives the safe result.
  if (!(bits <= kMaxQuantizationBits)) return kMaxQuantizationBits;
  return std::max(kMinBits, static_cast<int>(bits));
}

double LongestSide(const Mesh& mesh) {
  double longest = 0;
  for (size_t m = 0; m < 3; ++m) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t vertex : triangle) {
        low = std::min(low, mesh.positions[vertex][m]);
        high = std::max(high, mesh.positions[vertex][m]);
      }
    }
    longest = std::max(longest, high - low);
  }
  return longest;
}

}  // namespace latvox::client
