#include "core/snap/corner_list.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "core/snap/padded_vertices.h"

namespace latvox {

// Memory is asked for what the next list will want; and for the numbers of its vertices some lines before, since
// processors that look ahead by themselves stop at the end of each page.
void CornerList::Fill(const SnappedMesh& mesh, size_t first, size_t count) {
  constexpr size_t kNumbersAhead = 64;  // triangles
  const PaddedVertices vertices(mesh);
  const std::array<uint32_t, 3>* const numbers = &mesh.triangles[first];
  const size_t left = mesh.triangles.size() - first, ahead = std::min(count, left - count);
  size = count;
  std::iota(triangles, triangles + count, static_cast<uint32_t>(first));
  const auto copy = [&](size_t n) {
    const auto& [i, j, k] = numbers[n];
    std::memcpy(&corners[0][n], vertices[i], sizeof(corners[0][n]));
    std::memcpy(&corners[1][n], vertices[j], sizeof(corners[1][n]));
    std::memcpy(&corners[2][n], vertices[k], sizeof(corners[2][n]));
  };
  for (size_t n = 0; n < ahead; ++n) {
    copy(n);
    hwy::Prefetch(&numbers[std::min(count + n + kNumbersAhead, left - 1)]);
    for (const uint32_t index : numbers[count + n]) hwy::Prefetch(vertices[index]);
  }
  for (size_t n = ahead; n < count; ++n) copy(n);
}

}  // namespace latvox
