// What a mesh may bring along for its voxels to carry: Attribute of the protocol.
#ifndef LATVOX_SERVER_BASE_MESH_ATTRIBUTES_H_
#define LATVOX_SERVER_BASE_MESH_ATTRIBUTES_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "absl/types/span.h"
#include "core/attributes/attributes.h"

namespace latvox {

enum class MeshAttribute : uint32_t { kPart, kMaterial, kColor };

// As the protocol calls it.
constexpr const char* NameOf(MeshAttribute attribute) {
  constexpr const char* kNames[] = {"part", "material", "color"};
  return kNames[static_cast<size_t>(attribute)];
}

// The largest number that stands for one. The least is 0.
constexpr uint32_t LargestOf(MeshAttribute attribute) {
  return attribute == MeshAttribute::kColor ? 0xFFFFFF : 0x7FFFFFFF;
}

// Different ones, in the order in which each vertex has their numbers. Plain bytes, to be sent to a decoder process.
struct MeshAttributes {
  uint32_t count = 0;
  std::array<MeshAttribute, kMaxAttributes> kinds{};

  bool operator==(const MeshAttributes&) const = default;
  absl::Span<const MeshAttribute> view() const { return absl::MakeConstSpan(kinds).first(count); }
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_MESH_ATTRIBUTES_H_
