// Vertices that a kernel may read four numbers at a time; the fourth is meaningless.
#ifndef LATVOX_CORE_TRIANGLES_PADDED_VERTICES_H_
#define LATVOX_CORE_TRIANGLES_PADDED_VERTICES_H_

#include <cstdint>

#include "core/snap/snap.h"

namespace latvox {

class PaddedVertices {
 public:
  explicit PaddedVertices(const SnappedMesh& mesh) : vertices_(mesh.vertices_lat.data()) {}

  // Points to four numbers.
  const int32_t* operator[](uint32_t index) const { return vertices_[index].data(); }

 private:
  const Vec3i* vertices_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TRIANGLES_PADDED_VERTICES_H_
