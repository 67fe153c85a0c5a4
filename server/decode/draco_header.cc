// Layout: https://google.github.io/draco/spec, and Draco 1.5.5's decoders for bitstreams before 2.2:
//   0 "DRACO"   5 version, major and minor   7 type   8 method   9 flags (2 bytes)   then metadata, then connectivity
#include "server/decode/draco_header.h"

#include <draco/compression/config/compression_shared.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

constexpr absl::string_view kMagic = "DRACO";
constexpr size_t kHeaderBytes = 11;
constexpr uint16_t kMetadataFlag = 0x8000;

struct Header {
  uint8_t major, minor, type, method;
  bool has_metadata;
  uint16_t version() const { return static_cast<uint16_t>(DRACO_BITSTREAM_VERSION(major, minor)); }
};

absl::Status Truncated() { return BadMesh("truncated or corrupt Draco data (header)"); }

absl::Status CheckVersion(const Header& header) {
  if (header.major >= 1 && header.version() <= draco::kDracoMeshBitstreamVersion) return absl::OkStatus();
  return BadMesh(absl::StrCat("Draco bitstream version ", header.major, ".", header.minor, " is not within 1.0 to ",
                              draco::kDracoMeshBitstreamVersionMajor, ".", draco::kDracoMeshBitstreamVersionMinor));
}

// Counts are fixed 32-bit words in bitstreams before `varint_since`.
bool ReadCount(draco::DecoderBuffer& buffer, uint16_t varint_since, uint32_t& count) {
  if (buffer.bitstream_version() < varint_since) return buffer.Decode(&count);
  return draco::DecodeVarint(&count, &buffer);
}

absl::Status CheckProportion(absl::string_view what, uint64_t declared, uint64_t most) {
  if (declared <= most) return absl::OkStatus();
  return BadMesh(
      absl::StrCat("truncated or corrupt Draco data (", declared, " ", what, " declared, room for ", most, ")"));
}

absl::Status CheckCounts(uint64_t faces, uint64_t points, const Limits& limits) {
  if (faces == 0) return BadMesh("no triangles");
  if (faces > limits.max_triangles) return LimitExceeded("mesh.triangles", faces, limits.max_triangles);
  if (points > limits.max_vertices) return LimitExceeded("mesh.vertices", points, limits.max_vertices);
  return absl::OkStatus();
}

absl::StatusOr<DeclaredCounts> CheckSequential(draco::DecoderBuffer& buffer, uint64_t size, const Limits& limits) {
  uint32_t faces = 0, points = 0;
  constexpr uint16_t kVarintSince = DRACO_BITSTREAM_VERSION(2, 2);
  if (!ReadCount(buffer, kVarintSince, faces) || !ReadCount(buffer, kVarintSince, points)) return Truncated();
  if (absl::Status status = CheckCounts(faces, points, limits); !status.ok()) return status;
  // Draco's own decoder insists on three bytes a face. The cost of points depends on the entropy coding of their
  // attributes.
  if (absl::Status status = CheckProportion("triangles", faces, size / 3); !status.ok()) return status;
  if (absl::Status status = CheckProportion("points", points, size * kMaxElementsPerByte); !status.ok()) return status;
  return DeclaredCounts{faces, points};
}

absl::StatusOr<DeclaredCounts> CheckEdgebreaker(draco::DecoderBuffer& buffer, uint64_t size, const Limits& limits) {
  uint8_t traversal = 0, extra_attributes = 0;
  uint32_t new_points = 0, points = 0, faces = 0, symbols = 0, splits = 0;
  constexpr uint16_t kVarintSince = DRACO_BITSTREAM_VERSION(2, 0);
  if (!buffer.Decode(&traversal)) return Truncated();
  if (buffer.bitstream_version() < DRACO_BITSTREAM_VERSION(2, 2) && !ReadCount(buffer, kVarintSince, new_points)) {
    return Truncated();
  }
  if (!ReadCount(buffer, kVarintSince, points) || !ReadCount(buffer, kVarintSince, faces) ||
      !buffer.Decode(&extra_attributes) || !ReadCount(buffer, kVarintSince, symbols) ||
      !ReadCount(buffer, kVarintSince, splits)) {
    return Truncated();
  }
  const uint64_t all_points = uint64_t{points} + new_points;
  if (absl::Status status = CheckCounts(faces, all_points, limits); !status.ok()) return status;
  // Each symbol makes one face, and a split symbol is a symbol. The decoder reserves a point for each split.
  if (absl::Status status = CheckProportion("symbols", symbols, faces); !status.ok()) return status;
  if (absl::Status status = CheckProportion("split symbols", splits, symbols); !status.ok()) return status;
  if (absl::Status status = CheckProportion("attributes", extra_attributes, kMaxExtraAttributes); !status.ok()) {
    return status;
  }
  const uint64_t most = std::max<uint64_t>(faces, all_points);
  if (absl::Status status = CheckProportion("triangles and points", most, size * kMaxElementsPerByte); !status.ok()) {
    return status;
  }
  return DeclaredCounts{faces, all_points};
}

absl::StatusOr<Header> ReadHeader(absl::string_view bytes) {
  if (bytes.substr(0, kMagic.size()) != kMagic) {
    return BadMesh(absl::StrCat("not a Draco file (", bytes.size(), " bytes, beginning with \"",
                                absl::CHexEscape(bytes.substr(0, kMagic.size())), "\"); plain arrays need raw_mesh"));
  }
  if (bytes.size() < kHeaderBytes) return Truncated();
  const auto byte = [&](size_t at) { return static_cast<uint8_t>(bytes[at]); };
  const uint16_t flags = static_cast<uint16_t>(byte(9) | byte(10) << 8);
  return Header{byte(5), byte(6), byte(7), byte(8), (flags & kMetadataFlag) != 0};
}

}  // namespace

absl::StatusOr<DeclaredCounts> CheckDracoHeader(absl::string_view bytes, const Limits& limits) {
  const absl::StatusOr<Header> header = ReadHeader(bytes);
  if (!header.ok()) return header.status();
  if (header->type == draco::POINT_CLOUD) return BadMesh("a Draco point cloud, not a triangle mesh");
  if (header->type != draco::TRIANGULAR_MESH) {
    return BadMesh(absl::StrCat("Draco geometry type ", header->type, " is not a triangle mesh (1)"));
  }
  if (header->method > draco::MESH_EDGEBREAKER_ENCODING) {
    return BadMesh(absl::StrCat("Draco method ", header->method, " is neither sequential (0) nor edgebreaker (1)"));
  }
  if (absl::Status status = CheckVersion(*header); !status.ok()) return status;

  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data() + kHeaderBytes, bytes.size() - kHeaderBytes, header->version());
  if (header->has_metadata && header->version() >= DRACO_BITSTREAM_VERSION(1, 3)) {
    draco::GeometryMetadata skipped;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &skipped)) return Truncated();
  }
  const auto rest = static_cast<uint64_t>(buffer.remaining_size());
  return header->method == draco::MESH_SEQUENTIAL_ENCODING ? CheckSequential(buffer, rest, limits)
                                                           : CheckEdgebreaker(buffer, rest, limits);
}

std::optional<uint64_t> DeclaredTriangles(absl::string_view head) {
  const absl::StatusOr<Header> header = ReadHeader(head);
  if (!header.ok() || header->has_metadata || header->version() < DRACO_BITSTREAM_VERSION(2, 2)) return std::nullopt;
  size_t at = kHeaderBytes;
  const auto read_count = [&]() -> std::optional<uint64_t> {
    constexpr int kBits = 7, kMostBits = 32;
    uint64_t count = 0;
    for (int shift = 0; shift < kMostBits && at < head.size(); shift += kBits) {
      const auto byte = static_cast<uint8_t>(head[at++]);
      count |= uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) return count;
    }
    return std::nullopt;
  };
  if (header->method == draco::MESH_EDGEBREAKER_ENCODING) {
    ++at;  // of the traversal
    if (!read_count()) return std::nullopt;
  }
  return read_count();
}

}  // namespace latvox
