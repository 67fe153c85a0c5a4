// Triangles that do not change any more: jobs of one mesh share them.
#ifndef LATVOX_CORE_MESH_SHARED_TRIANGLES_H_
#define LATVOX_CORE_MESH_SHARED_TRIANGLES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/mesh.h"

namespace latvox {

// Copies are of the same triangles. What was moved from may only be assigned to, or destroyed.
class SharedTriangles {
 public:
  using Triangle = std::array<uint32_t, 3>;  // indices of vertices

  SharedTriangles() = default;
  SharedTriangles(std::vector<Triangle> triangles)
      : SharedTriangles(std::make_shared<const TriangleMesh>(TriangleMesh{{}, std::move(triangles)})) {}
  // Those of a mesh, which lives as long as this.
  explicit SharedTriangles(std::shared_ptr<const TriangleMesh> mesh)
      : mesh_(std::move(mesh)), triangles_(mesh_->triangles) {}

  size_t size() const { return triangles_.size(); }
  const Triangle& operator[](size_t n) const { return triangles_[n]; }
  auto begin() const { return triangles_.begin(); }
  auto end() const { return triangles_.end(); }

 private:
  std::shared_ptr<const TriangleMesh> mesh_;
  std::span<const Triangle> triangles_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_MESH_SHARED_TRIANGLES_H_
