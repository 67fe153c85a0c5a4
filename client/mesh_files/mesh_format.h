// How to recognize the formats of meshes.
#ifndef LATVOX_CLIENT_MESH_FILES_MESH_FORMAT_H_
#define LATVOX_CLIENT_MESH_FILES_MESH_FORMAT_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "latvox/mesh_files/read_mesh_file.h"

namespace latvox::client {

// The formats with their extensions, without the dot, which are also the words of --input-format.
const std::vector<std::pair<std::string, MeshFormat>>& MeshFormats();

// Returns the format of a file by its extension, in any case.
std::optional<MeshFormat> FormatOfPath(const std::string& path);

// Removes the UTF-8 byte order mark that some editors put before a text. .obj, .ply, .stl, .off and .gltf may be text,
// and their binary files begin with their own letters.
absl::string_view WithoutByteOrderMark(absl::string_view bytes);

// Returns the format by the first bytes after a byte order mark:
//   .drc    "DRACO"
//   .ply    "ply" and the end of a line
//   .glb    "glTF"
//   .3mf    a zip archive
//   .gltf   "{" after white space
//   .stl    "solid", or the length of binary STL by its count
//   .off    OFF, COFF and so on, after comments, followed by a number, BINARY, or the end of the line
//   .obj    otherwise, in text, a line "v ..."
std::optional<MeshFormat> FormatOfBytes(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_MESH_FORMAT_H_
