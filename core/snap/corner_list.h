// The corners of a list of triangles, side by side: kernels that come back to them need not look at the mesh again.
#ifndef LATVOX_CORE_SNAP_CORNER_LIST_H_
#define LATVOX_CORE_SNAP_CORNER_LIST_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/snap/snap.h"

namespace latvox {

// Whole vectors can be read and written; what lies behind the list means nothing.
struct CornerList {
  static constexpr size_t kMost = 512, kSlack = 64;  // about what a core's first-level cache holds

  size_t size = 0;
  uint32_t triangles[kMost + kSlack];                             // their numbers
  alignas(64) std::array<int32_t, 4> corners[3][kMost + kSlack];  // of vertices_lat; the fourth number means nothing

  // Of the mesh's triangles from `first` on, up to kMost of them.
  void Fill(const SnappedMesh& mesh, size_t first, size_t count);

  // Of a list that may be this one, if the place is not before the end.
  void Append(const CornerList& other, size_t place) {
    triangles[size] = other.triangles[place];
    for (size_t n = 0; n < 3; ++n) corners[n][size] = other.corners[n][place];
    ++size;
  }

  Vec3i Corner(size_t n, size_t place) const {
    const auto& corner = corners[n][place];
    return {corner[0], corner[1], corner[2]};
  }
};

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_CORNER_LIST_H_
