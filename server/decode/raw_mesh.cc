#include "server/decode/raw_mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>
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

// These loops have no branches, so that compilers can vectorize them. Returns the index of the first number that is not
// finite, or `count`.
template <class T>
uint64_t FirstNotFinite(const char* numbers, uint64_t count) {
  using Bits = std::conditional_t<sizeof(T) == sizeof(uint64_t), uint64_t, uint32_t>;
  constexpr auto kInfinity = std::bit_cast<Bits>(std::numeric_limits<T>::infinity());
  const auto is_bad = [](const char* at) { return (NumberAt<Bits>(at) & (~Bits{0} >> 1)) >= kInfinity; };
  Bits any = 0;
  for (uint64_t n = 0; n < count; ++n) any |= is_bad(numbers + n * sizeof(T)) ? 1 : 0;
  uint64_t first = any == 0 ? count : 0;
  while (first < count && !is_bad(numbers + first * sizeof(T))) ++first;
  return first;
}

// Returns the index of the first number that is not below the limit, or `count`.
uint64_t FirstNotBelow(uint64_t limit, const char* numbers, uint64_t count) {
  const auto is_bad = [limit](const char* at) { return NumberAt<uint32_t>(at) >= limit; };
  uint32_t any = 0;
  for (uint64_t n = 0; n < count; ++n) any |= is_bad(numbers + n * kIndex) ? 1 : 0;
  uint64_t first = any == 0 ? count : 0;
  while (first < count && !is_bad(numbers + first * kIndex)) ++first;
  return first;
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

// Copies `count` elements that begin at a byte of the cord. Ends soon once stopped, with fewer.
template <class Vector>
void CopyAll(const absl::Cord& bytes, uint64_t begin, uint64_t count, StopSignal stop, Vector& out) {
  constexpr uint64_t kElement = sizeof(typename Vector::value_type), kPiece = (1 << 20) / kElement;
  out.reserve(count);
  for (uint64_t n = 0; n < count && !stop.Stopped(); n += kPiece) {
    const uint64_t some = std::min(kPiece, count - n);
    out.resize(n + some);
    Copy(bytes, begin + n * kElement, some * kElement, out.data() + n);
  }
}

// Returns the index of the field among those of the layout.
absl::StatusOr<size_t> IndexOf(Field wanted, const RawMeshLayout& layout) {
  const auto fields = layout.attributes.view();
  const auto found = std::find(fields.begin(), fields.end(), wanted);
  if (found != fields.end()) return static_cast<size_t>(found - fields.begin());
  return MakeError(absl::StatusCode::kInvalidArgument, absl::StrCat("fields: the mesh has no ", NameOf(wanted)),
                   {"BAD_MESH", "fields", NameOf(wanted), ""});
}

absl::Status CheckNumber(Field field, uint64_t vertex, uint32_t number) {
  const uint32_t largest = FactsOf(field).largest;
  if (number <= largest) return absl::OkStatus();
  return BadMesh(
      absl::StrCat("the ", NameOf(field), " of vertex ", vertex, ", ", number, ", is not within 0 and ", largest));
}

// Puts the numbers of the wanted attributes, array after array in the bytes, vertex after vertex into the mesh.
absl::Status ReadAttributes(const absl::Cord& bytes, const RawMeshLayout& layout, const FieldList& wanted,
                            StopSignal stop, TriangleMesh& mesh) {
  const size_t count = wanted.size();
  std::vector<uint64_t> begins;  // of the arrays
  for (const Field field : wanted.view()) {
    const absl::StatusOr<size_t> index = IndexOf(field, layout);
    if (!index.ok()) return index.status();
    begins.push_back(AttributesAt(layout) + *index * layout.vertices * kIndex);
  }
  constexpr uint64_t kPiece = 1 << 16;  // vertices
  std::vector<uint32_t> numbers;
  mesh.attributes.reserve(layout.vertices * count);
  for (uint64_t first = 0; first < layout.vertices && !wanted.empty() && !stop.Stopped(); first += kPiece) {
    numbers.resize(std::min(kPiece, layout.vertices - first));
    mesh.attributes.resize((first + numbers.size()) * count);
    for (size_t n = 0; n < count; ++n) {
      Copy(bytes, begins[n] + first * kIndex, numbers.size() * kIndex, numbers.data());
      for (size_t v = 0; v < numbers.size(); ++v) {
        if (absl::Status status = CheckNumber(wanted.view()[n], first + v, numbers[v]); !status.ok()) return status;
        mesh.attributes[(first + v) * count + n] = numbers[v];
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

uint64_t RawMeshLayout::bytes() const { return AttributesAt(*this) + vertices * attributes.size() * kIndex; }

size_t RawMeshCheck::width() const { return at_ < TrianglesAt(layout_) ? PositionBytes(layout_) : kIndex; }

uint64_t RawMeshCheck::SectionEnd() const {
  const uint64_t triangles_at = TrianglesAt(layout_), attributes_at = AttributesAt(layout_);
  if (at_ < triangles_at) return triangles_at;
  if (at_ < attributes_at) return attributes_at;
  const uint64_t attribute_bytes = layout_.vertices * kIndex;
  return at_ + attribute_bytes - (at_ - attributes_at) % attribute_bytes;
}

absl::Status RawMeshCheck::CheckRun(const char* numbers, uint64_t count) const {
  const uint64_t triangles_at = TrianglesAt(layout_), attributes_at = AttributesAt(layout_);
  if (at_ < triangles_at) {
    const uint64_t bad =
        layout_.has_doubles ? FirstNotFinite<double>(numbers, count) : FirstNotFinite<float>(numbers, count);
    if (bad == count) return absl::OkStatus();
    const uint64_t vertex = (at_ + bad * PositionBytes(layout_)) / (3 * PositionBytes(layout_));
    return BadMesh(absl::StrCat("vertex ", vertex, " is not finite"));
  }
  const uint64_t first = (at_ - (at_ < attributes_at ? triangles_at : attributes_at)) / kIndex;
  if (at_ < attributes_at) {
    const uint64_t bad = FirstNotBelow(layout_.vertices, numbers, count);
    if (bad == count) return absl::OkStatus();
    return BadMesh(absl::StrCat("triangle ", (first + bad) / 3, " uses vertex ",
                                NumberAt<uint32_t>(numbers + bad * kIndex), " of ", layout_.vertices));
  }
  const Field field = layout_.attributes.view()[first / layout_.vertices];
  const uint64_t bad = FirstNotBelow(uint64_t{FactsOf(field).largest} + 1, numbers, count);
  if (bad == count) return absl::OkStatus();
  return CheckNumber(field, (first + bad) % layout_.vertices, NumberAt<uint32_t>(numbers + bad * kIndex));
}

// Whole numbers in place are judged together, because callbacks of gRPC run this. Only a bad one is looked for.
absl::Status RawMeshCheck::Add(absl::string_view piece) {
  const uint64_t end = layout_.bytes();
  while (!piece.empty() && at_ < end) {
    const size_t bytes = width();
    if (begun_.empty() && piece.size() >= bytes) {
      const uint64_t count = std::min<uint64_t>(piece.size(), SectionEnd() - at_) / bytes;
      if (absl::Status status = CheckRun(piece.data(), count); !status.ok()) return status;
      piece.remove_prefix(count * bytes);
      at_ += count * bytes;
      continue;
    }
    const size_t more = std::min(bytes - begun_.size(), piece.size());
    begun_.append(piece.data(), more);
    piece.remove_prefix(more);
    if (begun_.size() < bytes) return absl::OkStatus();
    if (absl::Status status = CheckRun(begun_.data(), 1); !status.ok()) return status;
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
    CopyAll(bytes, 0, layout.vertices, stop, mesh.double_vertices);
  } else {
    CopyAll(bytes, 0, layout.vertices, stop, mesh.vertices);
  }
  CopyAll(bytes, TrianglesAt(layout), layout.triangles, stop, mesh.triangles);
  if (absl::Status status = ReadAttributes(bytes, layout, wanted, stop, mesh); !status.ok()) return status;
  if (stop.Stopped()) return absl::CancelledError("the request was cancelled");
  if (absl::Status status = CheckMesh(mesh, stop); !status.ok()) return WithCauseOfCore(status);
  return mesh;
}

}  // namespace latvox
