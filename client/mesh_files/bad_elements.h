// Broken elements of a mesh: of a file, or of arrays.
#ifndef LATVOX_CLIENT_MESH_FILES_BAD_ELEMENTS_H_
#define LATVOX_CLIENT_MESH_FILES_BAD_ELEMENTS_H_

#include <cmath>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Each broken element is an error, unless ParseOptions::skip_bad is set.
class BadElements {
 public:
  explicit BadElements(const ParseOptions& options) : skip_(options.skip_bad) {}

  // Returns the error; or OK if the element is to be left out, which counts it. `element` is as in Warning.
  absl::Status Add(const absl::Status& error, const std::string& element);

  // Adds the warning BAD_ELEMENTS if elements were left out.
  void Report(Mesh& mesh) const;

 private:
  bool skip_;
  uint64_t count_ = 0;
  Warning first_;
};

inline bool IsFinite(const Vec3d& position) {
  return std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(position[2]);
}

// Returns "; " and the warning BAD_ELEMENTS of the mesh, for the error that no triangle is left; "" if it has none.
std::string LeftOut(const Mesh& mesh);

// Removes the positions that are not finite. No triangle may use one.
void RemoveNotFinite(Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_BAD_ELEMENTS_H_
