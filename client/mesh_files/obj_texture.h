// Textures of Wavefront OBJ files.
#ifndef LATVOX_CLIENT_MESH_FILES_OBJ_TEXTURE_H_
#define LATVOX_CLIENT_MESH_FILES_OBJ_TEXTURE_H_

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/mtl_file.h"

namespace latvox::client {

// The places of corners in images. v points up, and is 0 at the lower edge.
class ObjTexturePoints {
 public:
  // Reads the `vt` statements of the text.
  explicit ObjTexturePoints(absl::string_view text);

  // Call it at each `vt`, because negative indices count back from there.
  void Pass() { ++passed_; }

  // Returns the place that a corner "7/2/3" names; NaN without one. Errors: INVALID_ARGUMENT naming line and index.
  absl::StatusOr<ImagePoint> Of(absl::string_view corner, size_t line) const;

 private:
  std::vector<ImagePoint> points_;
  size_t passed_ = 0;
};

// Cuts a polygon as Triangulate does, and appends a TriangleBaseColor with the places of its corners for each triangle.
void TriangulateWithPlaces(const std::vector<uint32_t>& polygon, const std::vector<ImagePoint>& places, Mesh& mesh);

// Gives the triangles their base colors, and moves their places as the textures of their materials ask. Triangles
// without places have none, with the warning IGNORED_TEXTURE. Reads the images from the folder of the material file.
//   of_material   name of each material, by number
// Errors, through `bad`: INVALID_ARGUMENT naming material and file.
absl::Status ApplyTextures(const MtlMaterials& materials, const std::vector<std::string>& of_material, BadElements& bad,
                           Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OBJ_TEXTURE_H_
