#include "client/mesh_files/indexed_faces.h"

#include <cmath>

#include "absl/container/inlined_vector.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/polygon.h"

namespace latvox::client {

absl::StatusOr<uint32_t> ToVertex(double index, const char* element, uint64_t n, const std::vector<Vec3d>& positions) {
  if (!(index >= 0 && index < static_cast<double>(positions.size()) && index == std::floor(index)))
    return Bad("vertex index ", index, " of ", element, " ", n, " is not within the ", positions.size(), " vertices");
  const auto vertex = static_cast<uint32_t>(index);
  if (IsFinite(positions[vertex])) return vertex;
  return Bad("vertex ", vertex, " is not finite (", absl::StrJoin(positions[vertex], " "), "), and ", element, " ", n,
             " uses it");
}

absl::Status AppendFace(const std::vector<double>& indices, uint64_t n, Mesh& mesh) {
  absl::InlinedVector<uint32_t, 8> corners;
  for (const double index : indices) {
    // A status for each corner would cost more than this test.
    if (index >= 0 && index < static_cast<double>(mesh.positions.size())) {
      const auto vertex = static_cast<uint32_t>(index);
      if (vertex == index && IsFinite(mesh.positions[vertex])) {
        corners.push_back(vertex);
        continue;
      }
    }
    return ToVertex(index, "face", n, mesh.positions).status();
  }
  if (corners.size() >= 3) {
    Triangulate(corners, mesh.positions, mesh.triangles);
  } else if (mesh.skipped++ == 0) {
    mesh.warnings.push_back({"SKIPPED_ELEMENTS",
                             absl::StrCat("faces of fewer than three corners are left out; the first: face ", n),
                             absl::StrCat("face ", n)});
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
