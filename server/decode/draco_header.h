// Checks the first bytes of a Draco file before its decoder reads them.
#ifndef LATVOX_SERVER_DECODE_DRACO_HEADER_H_
#define LATVOX_SERVER_DECODE_DRACO_HEADER_H_

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/base/limits.h"

namespace latvox {

// The most faces, and the most points, for each byte of a valid edgebreaker file.
//
// There is no provable minimum of bytes: valence contexts and prediction residuals go through rANS, where a symbol that
// never changes costs nothing. The densest files are flat grids aligned with the quantization: with Draco 1.5.5, 4097 x
// 4097 points on 13 bits have 1371 faces a byte. Real meshes stay below 10. Three times the densest still keeps a file
// of some hundred bytes from claiming gigabytes (google/draco#1169: 61 bytes, 20 GB).
inline constexpr uint64_t kMaxElementsPerByte = 4096;

// The most attributes besides POSITION with a connectivity of their own. The decoder keeps tables over all corners for
// each.
inline constexpr uint32_t kMaxExtraAttributes = 16;

// What a Draco mesh declares: its triangles, and the points of its connectivity.
struct DeclaredCounts {
  uint64_t triangles = 0, points = 0;
};

// Checks that `bytes` begin like a Draco triangle mesh, with declared counts within `limits` and in proportion to the
// number of bytes. Returns the counts. Does not check the rest. Errors: INVALID_ARGUMENT (not Draco, not a mesh,
// truncated, counts out of proportion); RESOURCE_EXHAUSTED (counts over `limits`).
absl::StatusOr<DeclaredCounts> CheckDracoHeader(absl::string_view bytes, const Limits& limits);

// Returns the number of triangles that a Draco mesh declares in its first kDracoHeadBytes bytes. Returns nothing where
// metadata come before it, and for bitstreams before 2.2. Reads nothing else, and trusts nothing.
inline constexpr size_t kDracoHeadBytes = 32;
std::optional<uint64_t> DeclaredTriangles(absl::string_view head);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DRACO_HEADER_H_
