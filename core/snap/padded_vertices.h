// Vertices that a kernel may read four numbers at a time, of which the fourth means nothing.
#ifndef LATVOX_CORE_SNAP_PADDED_VERTICES_H_
#define LATVOX_CORE_SNAP_PADDED_VERTICES_H_

#include <array>
#include <cstdint>

#include "core/snap/snap.h"

namespace latvox {

class PaddedVertices {
 public:
  // Keeps a reference to the mesh.
  explicit PaddedVertices(const SnappedMesh& mesh)
      : vertices_(mesh.vertices_lat.data()), last_(static_cast<uint32_t>(mesh.vertices_lat.size()) - 1) {
    const Vec3i& v = mesh.vertices_lat.back();
    padded_last_ = {v[0], v[1], v[2], 0};
  }

  // Of four numbers.
  const int32_t* operator[](uint32_t index) const {
    return index == last_ ? padded_last_.data() : vertices_[index].data();
  }

 private:
  const Vec3i* vertices_;
  uint32_t last_;
  std::array<int32_t, 4> padded_last_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_PADDED_VERTICES_H_
