// The first bytes of a Draco file, read before its decoder may.
#ifndef LATVOX_SERVER_DECODE_DRACO_HEADER_H_
#define LATVOX_SERVER_DECODE_DRACO_HEADER_H_

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "server/base/limits.h"

namespace latvox {

// Most faces, and most points, that a byte of an edgebreaker file is believed to stand for.
//
// There is no provable minimum: valence contexts and prediction residuals go through rANS, where a symbol that never
// changes costs nothing. The densest files are flat grids aligned with the quantization: measured with Draco 1.5.5,
// 4097 x 4097 points on 13 bits, 1371 faces a byte; real meshes stay below 10. Three times the densest still keeps a
// file of some hundred bytes from claiming gigabytes (google/draco#1169: 61 bytes, 20 GB).
inline constexpr uint64_t kMaxElementsPerByte = 4096;

// Most attributes besides POSITION with a connectivity of their own; the decoder keeps tables over all corners for
// each.
inline constexpr uint32_t kMaxExtraAttributes = 16;

// Checks that `bytes` begin like a Draco triangle mesh whose declared counts are within `limits` and in proportion to
// the number of bytes. Says nothing about the rest.
// Errors: INVALID_ARGUMENT (not Draco, not a mesh, truncated, counts out of proportion), RESOURCE_EXHAUSTED (counts
// over `limits`).
absl::Status CheckDracoHeader(absl::string_view bytes, const Limits& limits);

// How many triangles a Draco mesh declares in its first kDracoHeadBytes bytes, if they tell: not where metadata come
// before, or in bitstreams before 2.2. Reads nothing else, and believes nothing.
inline constexpr size_t kDracoHeadBytes = 32;
std::optional<uint64_t> DeclaredTriangles(absl::string_view head);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DRACO_HEADER_H_
