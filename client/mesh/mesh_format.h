// The formats of meshes, and how they are told apart.
#ifndef LATVOX_CLIENT_MESH_MESH_FORMAT_H_
#define LATVOX_CLIENT_MESH_MESH_FORMAT_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"

namespace latvox::client {

enum class MeshFormat { kDraco, kObj, kPly, kStl, kGlb, kGltf, kThreeMf };

// With their extensions, without the dot, which are also the words of --input-format.
const std::vector<std::pair<std::string, MeshFormat>>& MeshFormats();

// Of a file, by its extension in whatever case.
std::optional<MeshFormat> FormatOfPath(const std::string& path);

// By how the bytes begin: "DRACO"; "ply" and the end of a line; "glTF"; a zip archive (3MF); "{" after white space
// (glTF); "solid" or the length that binary STL has by its count; else, in text, a line "v ..." (OBJ).
std::optional<MeshFormat> FormatOfBytes(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_FORMAT_H_
