// Links that the mesh crosses, one after the other.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_LINK_ROWS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_LINK_ROWS_H_

#include <cstddef>
#include <cstdint>

#include "latvox/for_each_voxel.h"
#include "latvox/types.h"

namespace latvox::client {

// A crossed link of a voxel. Fields that the request lacks have these values.
struct LinkRow {
  Vec3i ijk;             // the voxel
  size_t voxel;          // its number in the batch
  size_t neighbor;       // the number of the other end's lattice vector in Accepted::neighbors
  float share = 0;       // of the link's length at which it first meets the mesh
  int32_t triangle = 0;  // the number of the triangle that it meets first
  int32_t crossings = 0;
};

// Calls visit(row) for each crossed link: voxels in their order, and the neighbors of each in theirs. Precondition: the
// batch has a field of links.
template <class Visit>
void ForEachCrossedLink(const BrickBatch& batch, Visit&& visit) {
  const FieldValues* const shares = FindField(batch.fields, Field::kLinks);
  const FieldValues* const triangles = FindField(batch.fields, Field::kLinkTriangles);
  const FieldValues* const crossings = FindField(batch.fields, Field::kLinkCrossings);
  const FieldValues& any = *(shares != nullptr ? shares : triangles != nullptr ? triangles : crossings);
  ForEachVoxel(batch, [&](const Voxel& voxel) {
    for (size_t neighbor = 0; neighbor < any.neighbors; ++neighbor) {
      const size_t n = voxel.number * any.neighbors + neighbor;
      if (!IsCrossed(any, n)) continue;
      LinkRow row{voxel.ijk, voxel.number, neighbor};
      if (shares != nullptr) row.share = shares->As<float>()[n];
      if (triangles != nullptr) row.triangle = static_cast<int32_t>(triangles->As<uint32_t>()[n]);
      if (crossings != nullptr) row.crossings = static_cast<int32_t>(crossings->As<uint32_t>()[n]);
      visit(row);
    }
  });
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_LINK_ROWS_H_
