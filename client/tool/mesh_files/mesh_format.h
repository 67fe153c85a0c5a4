// The formats of meshes, and how they are told apart.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_MESH_FORMAT_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_MESH_FORMAT_H_

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

// Without the UTF-8 byte order mark that some editors put before a text: of the formats, .obj, .ply, .stl and .gltf can
// be one, and a binary file of these begins with its own letters.
absl::string_view WithoutByteOrderMark(absl::string_view bytes);

// By how the bytes begin, after a byte order mark: "DRACO"; "ply" and the end of a line; "glTF"; a zip archive (3MF);
// "{" after white space (glTF); "solid" or the length that binary STL has by its count; else, in text, a line "v ..."
// (OBJ).
std::optional<MeshFormat> FormatOfBytes(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_MESH_FORMAT_H_
