#include "server/decode/draco_decoder.h"

#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/decode.h>
#include <draco/core/quantization_utils.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/decode/draco_attributes.h"

namespace latvox {
namespace {

// Decodes without the dequantization of POSITION, which would lose the number of bits.
absl::StatusOr<std::unique_ptr<draco::Mesh>> RunDraco(absl::string_view bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  decoder.SetSkipAttributeTransform(draco::GeometryAttribute::POSITION);
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) return CorruptDraco(mesh.status().error_msg_string());
  return std::move(mesh).value();
}

// Sends `count` elements to `send` in pieces; `make(n, element)` fills in the nth. Stops at its first error.
template <class Element, class Make, class Send>
absl::Status SendPieces(uint32_t count, const Make& make, const Send& send) {
  std::array<Element, MeshSink::kMaxPiece> piece;
  for (uint32_t first = 0; first < count;) {
    const uint32_t size = std::min<uint32_t>(count - first, MeshSink::kMaxPiece);
    for (uint32_t n = 0; n < size; ++n) {
      if (absl::Status status = make(first + n, piece[n]); !status.ok()) return status;
    }
    send(absl::MakeSpan(piece.data(), size));
    first += size;
  }
  return absl::OkStatus();
}

bool IsQuantized(const draco::PointAttribute& attribute) {
  const draco::AttributeTransformData* transform = attribute.GetAttributeTransformData();
  return transform != nullptr && transform->transform_type() == draco::ATTRIBUTE_QUANTIZATION_TRANSFORM;
}

// Reads the positions of points, for all number types of attributes. It dequantizes like Draco's decoder, which was
// told to skip that step: without another copy of all positions, and equally on all architectures.
class PositionReader {
 public:
  static absl::StatusOr<PositionReader> Create(const draco::PointAttribute& positions, uint32_t points) {
    PositionReader reader(positions);
    if (absl::Status status = CheckValues(positions, points, "POSITION"); !status.ok()) return status;
    const bool side_by_side = positions.byte_stride() == sizeof(Vec3f);
    if (IsQuantized(positions)) {
      if (!side_by_side || !reader.InitQuantization()) return CorruptDraco("quantization");
    } else if (side_by_side && positions.data_type() == draco::DT_FLOAT32) {
      reader.form_ = Form::kFloats;
    }
    return reader;
  }

  uint32_t quantization_bits() const { return bits_; }

  absl::Status Read(uint32_t point, Vec3f& out) const {
    const draco::AttributeValueIndex value = positions_.mapped_index(draco::PointIndex(point));
    if (value.value() >= positions_.size()) return CorruptDraco(absl::StrCat("vertex ", point, " has no position"));
    if (!Convert(value, out) || !std::isfinite(out[0]) || !std::isfinite(out[1]) || !std::isfinite(out[2])) {
      return BadMesh(absl::StrCat("vertex ", point, " is not finite"));
    }
    return absl::OkStatus();
  }

 private:
  enum class Form { kFloats, kQuantized, kOther };

  explicit PositionReader(const draco::PointAttribute& positions) : positions_(positions) {}

  bool InitQuantization() {
    draco::AttributeQuantizationTransform quantization;
    if (!quantization.InitFromAttribute(positions_)) return false;
    const int bits = quantization.quantization_bits();
    if (bits < 1 || bits > 30 || quantization.min_values().size() != least_.size()) return false;
    std::copy_n(quantization.min_values().begin(), least_.size(), least_.begin());
    bits_ = static_cast<uint32_t>(bits);
    form_ = Form::kQuantized;
    return dequantizer_.Init(quantization.range(), (1 << bits) - 1);
  }

  bool Convert(draco::AttributeValueIndex value, Vec3f& out) const {
    if (form_ == Form::kOther) return positions_.ConvertValue<float>(value, 3, out.data());
    const uint8_t* const from = positions_.GetAddress(value);
    if (form_ == Form::kFloats) {
      std::memcpy(out.data(), from, sizeof(out));
      return true;
    }
    Vec3i steps;
    std::memcpy(steps.data(), from, sizeof(steps));
    for (size_t m = 0; m < 3; ++m) out[m] = dequantizer_.DequantizeFloat(steps[m]) + least_[m];
    return true;
  }

  const draco::PointAttribute& positions_;
  Form form_ = Form::kOther;
  draco::Dequantizer dequantizer_;
  Vec3f least_{};
  uint32_t bits_ = 0;
};

absl::StatusOr<draco::PointAttribute*> PositionsOf(draco::Mesh& mesh) {
  const int id = mesh.GetNamedAttributeId(draco::GeometryAttribute::POSITION);
  if (id < 0) return BadMesh("no POSITION attribute");
  draco::PointAttribute* positions = mesh.attribute(id);
  if (positions->data_type() == draco::DT_BOOL) return BadMesh("POSITION holds truth values, not numbers");
  // Whole numbers stand for themselves. Draco takes this flag from the stream unchecked, as a bool of any value.
  positions->set_normalized(false);
  const int components = positions->num_components();
  if (components != 3) return BadMesh(absl::StrCat("POSITION has ", components, " components, not 3"));
  return positions;
}

// Draco does not promise that indices are in range.
absl::Status SendTriangles(const draco::Mesh& mesh, MeshSink& sink) {
  using Triangle = std::array<uint32_t, 3>;
  const uint32_t points = mesh.num_points();
  const auto read = [&](uint32_t t, Triangle& out) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(t));
    for (size_t corner = 0; corner < 3; ++corner) {
      out[corner] = face[corner].value();
      if (out[corner] >= points) {
        return BadMesh(absl::StrCat("triangle ", t, " refers to vertex ", out[corner], " of ", points));
      }
    }
    return absl::OkStatus();
  };
  return SendPieces<Triangle>(mesh.num_faces(), read, [&](absl::Span<const Triangle> piece) { sink.Triangles(piece); });
}

absl::Status SendAttributes(const DracoAttributes& attributes, uint32_t points, MeshSink& sink) {
  const uint32_t count = attributes.count();
  const auto read = [&](uint32_t n, uint32_t& out) { return attributes.Read(n / count, n % count, out); };
  return SendPieces<uint32_t>(points * count, read, [&](absl::Span<const uint32_t> piece) { sink.Attributes(piece); });
}

// Decoders split points, so the header's counts are not final.
absl::Status CheckCounts(const draco::Mesh& mesh, const Limits& limits, const FieldList& wanted) {
  if (mesh.num_faces() == 0) return BadMesh("no triangles");
  if (mesh.num_faces() > limits.max_triangles) {
    return LimitExceeded("mesh.triangles", mesh.num_faces(), limits.max_triangles);
  }
  // The number of all vertices' attributes fits in 32 bits.
  const uint64_t most = std::min<uint64_t>(limits.max_vertices, UINT32_MAX / std::max(wanted.size(), 1U));
  if (mesh.num_points() > most) return LimitExceeded("mesh.vertices", mesh.num_points(), most);
  return absl::OkStatus();
}

absl::Status DecodeChecked(absl::string_view bytes, const Limits& limits, const FieldList& wanted, MeshSink& sink) {
  const absl::StatusOr<DeclaredCounts> declared = CheckDracoHeader(bytes, limits);
  if (!declared.ok()) return declared.status();
  sink.Declare(*declared);
  const absl::StatusOr<std::unique_ptr<draco::Mesh>> mesh = RunDraco(bytes);
  if (!mesh.ok()) return mesh.status();
  if (absl::Status status = CheckCounts(**mesh, limits, wanted); !status.ok()) return status;
  const absl::StatusOr<draco::PointAttribute*> attribute = PositionsOf(**mesh);
  if (!attribute.ok()) return attribute.status();
  const absl::StatusOr<PositionReader> positions = PositionReader::Create(**attribute, (*mesh)->num_points());
  if (!positions.ok()) return positions.status();
  const MeshSize size{(*mesh)->num_points(), (*mesh)->num_faces(), positions->quantization_bits()};
  const absl::StatusOr<DracoAttributes> attributes = DracoAttributes::Find(**mesh, wanted);
  if (!attributes.ok()) return attributes.status();
  sink.Begin(size);
  const auto read = [&](uint32_t point, Vec3f& out) { return positions->Read(point, out); };
  const auto send = [&](absl::Span<const Vec3f> piece) { sink.Vertices(piece); };
  if (absl::Status status = SendPieces<Vec3f>(size.vertices, read, send); !status.ok()) return status;
  if (absl::Status status = SendAttributes(*attributes, size.vertices, sink); !status.ok()) return status;
  return SendTriangles(**mesh, sink);
}

class CollectingSink final : public MeshSink {
 public:
  explicit CollectingSink(DecodedMesh& out) : out_(out) {}
  void Declare(const DeclaredCounts& /*counts*/) override {}
  void Begin(const MeshSize& size) override {
    out_.quantization_bits = size.quantization_bits;
    out_.mesh.vertices.reserve(size.vertices);
    out_.mesh.triangles.reserve(size.triangles);
  }
  void Vertices(absl::Span<const Vec3f> piece) override {
    out_.mesh.vertices.insert(out_.mesh.vertices.end(), piece.begin(), piece.end());
  }
  void Attributes(absl::Span<const uint32_t> piece) override {
    out_.mesh.attributes.insert(out_.mesh.attributes.end(), piece.begin(), piece.end());
  }
  void Triangles(absl::Span<const std::array<uint32_t, 3>> piece) override {
    out_.mesh.triangles.insert(out_.mesh.triangles.end(), piece.begin(), piece.end());
  }

 private:
  DecodedMesh& out_;
};

}  // namespace

absl::Status NoMemoryToDecode() {
  return MakeError(absl::StatusCode::kResourceExhausted, "mesh: decoding needs more memory than there is",
                   {"OUT_OF_MEMORY", "mesh", "", ""});
}

bool IsOutOfMemory(const absl::Status& status) {
  return CauseOf(status).value_or(ErrorCause{}).reason == "OUT_OF_MEMORY";
}

absl::Status DecodeDraco(absl::string_view bytes, const Limits& limits, const FieldList& wanted, MeshSink& sink) {
  try {
    return DecodeChecked(bytes, limits, wanted, sink);
  } catch (const std::bad_alloc&) {
    return NoMemoryToDecode();
  } catch (const std::exception& error) {
    return CorruptDraco(error.what());
  }
}

absl::StatusOr<DecodedMesh> DecodeDraco(absl::string_view bytes, const Limits& limits, const FieldList& wanted) {
  DecodedMesh mesh;
  CollectingSink sink(mesh);
  if (absl::Status status = DecodeDraco(bytes, limits, wanted, sink); !status.ok()) return status;
  return mesh;
}

}  // namespace latvox
