// Along which directions lattice lines may meet which triangles.
#ifndef LATVOX_CORE_DIGITIZE_SIFT_H_
#define LATVOX_CORE_DIGITIZE_SIFT_H_

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/uninitialized.h"
#include "core/digitize/fineness.h"
#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"

namespace latvox {

// Of a tiny triangle, one between whose corners lies no more than one lattice line, whatever the direction: bit n says
// that a line along frames[n] may meet it. All others have kNotTiny alone.
using MetLines = uint16_t;
inline constexpr MetLines kNotTiny = 1 << 15;
static_assert(kMaxPairs <= 15);

// Sets met[t] for each of the triangles, and appends them to `kept`, in their order, but for the tiny ones that no line
// can meet: they cross no lattice edge and contribute nothing. The scalar kernel takes none for tiny.
void Sift(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
          std::span<MetLines> met, std::vector<uint32_t>& kept);

// The triangles of the mesh that lattice lines may meet, ascending, by all threads of the arena: by `fineness`, as
// FindTouching says (core/digitize/touching.h), as Sift says, by both, or all. With Sift, `met` is sized for all
// triangles and set for those returned. Some are missing once the job is cancelled.
std::vector<uint32_t> SiftAll(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const Fineness& fineness,
                              const std::atomic<bool>& cancelled, UninitializedVector<MetLines>& met);

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_SIFT_H_
