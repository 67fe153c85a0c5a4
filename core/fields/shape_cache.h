// Triangles prepared for distances, as far as they were used lately.
#ifndef LATVOX_CORE_FIELDS_SHAPE_CACHE_H_
#define LATVOX_CORE_FIELDS_SHAPE_CACHE_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "core/band/metric.h"
#include "core/band/triangle_distance.h"
#include "core/snap/snap.h"

namespace latvox {

// Neighboring voxels mostly meet the same triangles. Memory: 320 KiB.
class ShapeCache {
 public:
  ShapeCache() : places_(kPlaces) {}

  // Forgets the triangles of another mesh.
  void Begin() {
    for (Place& place : places_) place.triangle = kNone;
  }

  // Valid until the next call.
  const TriangleDistance& At(const SnappedMesh& mesh, const Metric& metric, uint32_t triangle) {
    Place& place = places_[triangle % kPlaces];
    if (place.triangle != triangle) {
      place.shape.emplace(metric, mesh.TriangleAt(triangle));
      place.triangle = triangle;
    }
    return *place.shape;
  }

 private:
  static constexpr size_t kPlaces = 1024;
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  struct Place {
    uint32_t triangle = kNone;
    std::optional<TriangleDistance> shape;
  };
  std::vector<Place> places_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_SHAPE_CACHE_H_
