// The corners of a list of triangles, side by side: kernels that come back to them need not look at the mesh again.
#ifndef LATVOX_CORE_SNAP_CORNER_LIST_H_
#define LATVOX_CORE_SNAP_CORNER_LIST_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/snap/snap.h"

namespace latvox {

// Whole vectors can be read; what lies behind the list means nothing.
struct CornerList {
  static constexpr size_t kMost = 1024, kSlack = 64;  // small beside a core's second-level cache

  size_t size = 0;
  uint32_t triangles[kMost + kSlack];                             // their numbers
  alignas(64) std::array<int32_t, 4> corners[3][kMost + kSlack];  // of vertices_lat; the fourth number means nothing

  // Of the mesh's triangles from `first` on, up to kMost of them.
  void Fill(const SnappedMesh& mesh, size_t first, size_t count);

  // Appends the triangle at a place >= size, which was in the list before `size` was set back: so some are left out.
  void Keep(size_t place) {
    triangles[size] = triangles[place];
    for (auto& corner : corners) corner[size] = corner[place];
    ++size;
  }

  Vec3i Corner(size_t n, size_t place) const {
    const auto& corner = corners[n][place];
    return {corner[0], corner[1], corner[2]};
  }
};
static_assert(std::has_single_bit(CornerList::kMost) && CornerList::kMost < 1 << 15,
              "places are masked, and fit 16 bits");

// Calls f() with `list` filled with the mesh's triangles from `begin` to `end`, one part after the other.
template <class F>
void ForEachList(const SnappedMesh& mesh, size_t begin, size_t end, CornerList& list, F&& f) {
  for (size_t first = begin; first < end; first += CornerList::kMost) {
    list.Fill(mesh, first, std::min(CornerList::kMost, end - first));
    f();
  }
}

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_CORNER_LIST_H_
