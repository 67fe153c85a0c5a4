// The labels of a mesh's triangles, for a labeled set.
#ifndef LATVOX_CORE_SOLID_LABELS_H_
#define LATVOX_CORE_SOLID_LABELS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/request/fields.h"
#include "core/request/labels.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"

namespace latvox {

// The label of a triangle is the smallest number of its corners. Ranks order the labels: 0 has the highest priority.
struct Labels {
  Field field = Field::kPart;          // whose numbers they are
  std::vector<uint32_t> numbers;       // by rank
  std::vector<uint16_t> of_triangles;  // their ranks

  // The mesh's triangles, those of a rank together: the n-th rank's are order[begins[n]] .. order[begins[n + 1] - 1].
  struct Groups {
    std::vector<uint32_t> order;
    std::vector<size_t> begins;
    std::span<const uint32_t> Of(size_t rank) const {
      return std::span(order).subspan(begins[rank], begins[rank + 1] - begins[rank]);
    }
  };
  // Once stopped, the result is meaningless, but has all ranks.
  Groups ByRank(StopSignal stop) const;
};

// The bytes of memory for each triangle, with the groups.
inline constexpr uint64_t kLabelBytesPerTriangle = 8;

// Errors: RESOURCE_EXHAUSTED if the triangles have more than request.most labels. Once stopped, the result is
// meaningless.
//   of_vertices  the numbers of each vertex, `stride` of them; the labels' is at `place`
absl::StatusOr<Labels> MakeLabels(const SnappedMesh& mesh, const LabelRequest& request,
                                  std::span<const uint32_t> of_vertices, size_t stride, size_t place, StopSignal stop);

// Returns the labels whose fractions voxels carry: those asked for, or all of the mesh, ascending, if none are. Errors:
// RESOURCE_EXHAUSTED if all are more than kMostFractionLabels.
absl::StatusOr<std::vector<uint32_t>> FractionLabelsOf(const Labels& labels, const std::vector<uint32_t>& asked);

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_LABELS_H_
