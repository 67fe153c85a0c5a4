// Wavefront material files.
#ifndef LATVOX_CLIENT_MESH_FILES_MTL_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_MTL_FILE_H_

#include <filesystem>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

using MaterialColors = absl::flat_hash_map<std::string, Color>;

// Reads the diffuse colors `Kd` of the materials in a text, as sRGB. Textures (`map_Kd`), and colors that are not
// three numbers on the scale of 1 or 255, give a warning.
void ParseMtl(absl::string_view text, MaterialColors& colors, std::vector<Warning>& warnings);

// Reads the files that an OBJ names in one `mtllib` statement of this line, in the folder. A file that is missing, or
// that cannot be read, gives the warning MISSING_FILE.
void ReadMaterials(absl::string_view names, size_t line, const std::filesystem::path& folder, MaterialColors& colors,
                   std::vector<Warning>& warnings);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_MTL_FILE_H_
