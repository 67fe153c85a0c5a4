#include "server/decode/raw_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr size_t kIndex = sizeof(uint32_t);

size_t PositionBytes(const RawMeshLayout& layout) { return layout.has_doubles ? sizeof(double) : sizeof(float); }

uint64_t TrianglesAt(const RawMeshLayout& layout) { return layout.vertices * 3 * PositionBytes(layout); }
uint64_t AttributesAt(const RawMeshLayout& layout) { return TrianglesAt(layout) + layout.triangles * 3 * kIndex; }

template <class T>
T NumberAt(const char* bytes) {
  T number;
  std::memcpy(&number, bytes, sizeof(T));
  return number;
}

// Copies bytes [begin, begin + size) of the cord.
void Copy(const absl::Cord& bytes, uint64_t begin, size_t size, void* out) {
  auto* to = static_cast<char*>(out);
  const absl::Cord part = bytes.Subcord(begin, size);
  for (const absl::string_view chunk : part.Chunks()) {
    std::memcpy(to, chunk.data(), chunk.size());
    to += chunk.size();
  }
}

// Returns the index of the attribute among those of the layout.
absl::StatusOr<size_t> IndexOf(Field wanted, const RawMeshLayout& layout) {
  const auto fields = layout.attributes.view();
  const auto found = std::find(fields.begin(), fields.end(), wanted);
  if (found != fields.end()) return static_cast<size_t>(found - fields.begin());
  return MakeError(absl::StatusCode::kInvalidArgument, absl::StrCat("attributes: the mesh has no ", NameOf(wanted)),
                   {"BAD_MESH", "attributes", NameOf(wanted), ""});
}

absl::Status CheckNumber(Field field, uint64_t vertex, uint32_t number) {
  const uint32_t largest = FactsOf(field).largest;
  if (number <= largest) return absl::OkStatus();
  return BadMesh(
      absl::StrCat("the ", NameOf(field), " of vertex ", vertex, ", ", number, ", is not within 0 and ", largest));
}

// Puts the numbers of the wanted attributes, array after array in the bytes, vertex after vertex into the mesh.
absl::Status ReadAttributes(const absl::Cord& bytes, const RawMeshLayout& layout, const FieldList& wanted,
                            TriangleMesh& mesh) {
  mesh.attributes.resize(layout.vertices * wanted.size());
  std::vector<uint32_t> numbers(wanted.empty() ? 0 : layout.vertices);
  for (size_t n = 0; n < wanted.size(); ++n) {
    const absl::StatusOr<size_t> index = IndexOf(wanted.view()[n], layout);
    if (!index.ok()) return index.status();
    const size_t size = numbers.size() * kIndex;
    Copy(bytes, AttributesAt(layout) + *index * size, size, numbers.data());
    for (size_t v = 0; v < numbers.size(); ++v) {
      if (absl::Status status = CheckNumber(wanted.view()[n], v, numbers[v]); !status.ok()) return status;
      mesh.attributes[v * wanted.size() + n] = numbers[v];
    }
  }
  return absl::OkStatus();
}

}  // namespace

uint64_t RawMeshLayout::bytes() const { return AttributesAt(*this) + vertices * attributes.size() * kIndex; }

size_t RawMeshCheck::width() const { return at_ < TrianglesAt(layout_) ? PositionBytes(layout_) : kIndex; }

absl::Status RawMeshCheck::Check(const char* number) const {
  const uint64_t triangles_at = TrianglesAt(layout_), attributes_at = AttributesAt(layout_);
  if (at_ < triangles_at) {
    const double x = layout_.has_doubles ? NumberAt<double>(number) : NumberAt<float>(number);
    if (std::isfinite(x)) return absl::OkStatus();
    return BadMesh(absl::StrCat("vertex ", at_ / (3 * PositionBytes(layout_)), " is not finite (", x, ")"));
  }
  const auto index = NumberAt<uint32_t>(number);
  if (at_ < attributes_at) {
    if (index < layout_.vertices) return absl::OkStatus();
    return BadMesh(absl::StrCat("triangle ", (at_ - triangles_at) / (3 * kIndex), " uses vertex ", index, " of ",
                                layout_.vertices));
  }
  const uint64_t n = (at_ - attributes_at) / kIndex;
  return CheckNumber(layout_.attributes.view()[n / layout_.vertices], n % layout_.vertices, index);
}

absl::Status RawMeshCheck::Add(absl::string_view piece) {
  const uint64_t end = layout_.bytes();
  while (!piece.empty() && at_ < end) {
    const size_t bytes = width();
    const char* number = piece.data();
    if (!begun_.empty() || piece.size() < bytes) {
      const size_t more = std::min(bytes - begun_.size(), piece.size());
      begun_.append(piece.data(), more);
      piece.remove_prefix(more);
      if (begun_.size() < bytes) return absl::OkStatus();
      number = begun_.data();
    } else {
      piece.remove_prefix(bytes);
    }
    if (absl::Status status = Check(number); !status.ok()) return status;
    begun_.clear();
    at_ += bytes;
  }
  return absl::OkStatus();
}

absl::StatusOr<TriangleMesh> ReadRawMesh(const absl::Cord& bytes, const RawMeshLayout& layout, const FieldList& wanted,
                                         StopSignal stop) {
  if (bytes.size() != layout.bytes()) {
    return BadMesh(absl::StrCat("raw_mesh describes ", layout.bytes(), " bytes, but the mesh has ", bytes.size()));
  }
  TriangleMesh mesh;
  if (layout.has_doubles) {
    mesh.double_vertices.resize(layout.vertices);
    Copy(bytes, 0, TrianglesAt(layout), mesh.double_vertices.data());
  } else {
    mesh.vertices.resize(layout.vertices);
    Copy(bytes, 0, TrianglesAt(layout), mesh.vertices.data());
  }
  mesh.triangles.resize(layout.triangles);
  Copy(bytes, TrianglesAt(layout), layout.triangles * 3 * kIndex, mesh.triangles.data());
  if (absl::Status status = ReadAttributes(bytes, layout, wanted, mesh); !status.ok()) return status;
  if (absl::Status status = CheckMesh(mesh, stop); !status.ok()) return WithCauseOfCore(status);
  return mesh;
}

}  // namespace latvox
