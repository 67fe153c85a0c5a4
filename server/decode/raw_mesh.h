// Meshes that come as plain arrays: RawMesh of the protocol.
#ifndef LATVOX_SERVER_DECODE_RAW_MESH_H_
#define LATVOX_SERVER_DECODE_RAW_MESH_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/cord.h"
#include "absl/strings/string_view.h"
#include "core/base/stop_signal.h"
#include "core/mesh/mesh.h"
#include "core/request/fields.h"

namespace latvox {

struct RawMeshLayout {
  uint64_t vertices = 0, triangles = 0;
  bool has_doubles = false;  // positions
  FieldList attributes = {};

  // Returns the length of all arrays. Precondition: vertices and triangles are below 2^40.
  uint64_t bytes() const;

  bool operator==(const RawMeshLayout&) const = default;
};

// Checks the numbers of the arrays while they arrive, so that a bad mesh is refused before all of it has come.
class RawMeshCheck {
 public:
  explicit RawMeshCheck(const RawMeshLayout& layout) : layout_(layout) {}

  // Checks the next bytes. Bytes beyond the layout's length are ignored. Errors: INVALID_ARGUMENT, BAD_MESH, naming the
  // element: a position that is not finite, an index beyond the vertices, an attribute beyond its range.
  absl::Status Add(absl::string_view piece);

 private:
  // Checks `count` numbers at `at_`, which are in one section: positions, triangles, or one attribute.
  absl::Status CheckRun(const char* numbers, uint64_t count) const;
  size_t width() const;         // bytes of the number at `at_`
  uint64_t SectionEnd() const;  // the byte after the section at `at_`

  const RawMeshLayout layout_;
  uint64_t at_ = 0;    // bytes checked
  std::string begun_;  // the first bytes of a number whose others have not come
};

// Makes the mesh with the wanted attributes. Errors: INVALID_ARGUMENT, BAD_MESH: another length, an attribute that the
// layout lacks, and as RawMeshCheck, because stored bytes may have come without a layout.
absl::StatusOr<TriangleMesh> ReadRawMesh(const absl::Cord& bytes, const RawMeshLayout& layout, const FieldList& wanted,
                                         StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_RAW_MESH_H_
