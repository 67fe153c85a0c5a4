// glTF 2.0.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_FILE_H_

#include <filesystem>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Returns all triangles of the default scene, or of the first scene, in world coordinates.
// - Transforms of nodes and their instances (EXT_mesh_gpu_instancing) and the center of CESIUM_RTC are applied, in
//   double. The corners of mirrored triangles are reversed, so that the outside stays outside.
// - Morph targets are applied with the weights of the node, otherwise of the mesh. Then skins are applied, in the pose
//   of the nodes. Animations are not applied, with a warning.
// - Each node with triangles is a part, and so is each instance.
// - Materials are numbered in order of first use. Triangles without a material get the number after the last one.
// - Colors are sRGB: those of vertices times the base color factor of the material. Beside such triangles, those with
//   neither are white, with a warning. Textures are read if the options ask for base colors; otherwise there is a
//   warning.
//
//   bytes    of a .glb or a .gltf
//   folder   of the files that it refers to; empty: the working directory
//   options  with skip_bad, triangles whose indices are out of range or whose vertices are not finite are left out
//   most     most triangles, and most vertices, of the scene, each counted as often as it is placed, because a few
//            bytes may place many
// Errors, without the path: as ParseGltfDocument; INVALID_ARGUMENT or RESOURCE_EXHAUSTED naming node, mesh and
// primitive, accessor or buffer, the fault, and the limit.
absl::StatusOr<Mesh> ParseGltf(absl::string_view bytes, const std::filesystem::path& folder,
                               const ParseOptions& options = {}, size_t most = kMostPlaced);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_FILE_H_
