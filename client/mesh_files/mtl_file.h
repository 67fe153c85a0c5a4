// Wavefront material files.
#ifndef LATVOX_CLIENT_MESH_FILES_MTL_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_MTL_FILE_H_

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// The texture `map_Kd` of a material.
struct MtlTexture {
  std::filesystem::path folder;                 // of the material file
  std::string name;                             // of the image file
  std::array<double, 2> offset{}, scale{1, 1};  // `-o` and `-s`: coordinates are scaled, then moved
  bool clamps = false;                          // `-clamp on`
};

struct MtlMaterials {
  absl::flat_hash_map<std::string, Color> colors;
  std::map<std::string, MtlTexture> textures;
};

// Reads the diffuse colors `Kd` of the materials in a text, as sRGB, and their textures `map_Kd`. Colors that are not
// three numbers on the scale of 1 or 255, and unknown options of textures, give a warning.
//   folder   of the text's file
void ParseMtl(absl::string_view text, const std::filesystem::path& folder, MtlMaterials& materials,
              std::vector<Warning>& warnings);

// Reads the files that an OBJ names in one `mtllib` statement of this line, in the folder. A file that is missing, or
// that cannot be read, gives the warning MISSING_FILE.
void ReadMaterials(absl::string_view names, size_t line, const std::filesystem::path& folder, MtlMaterials& materials,
                   std::vector<Warning>& warnings);

// Returns the path of the regular file of this name in the folder, also if its name has quotes or the backslashes of
// Windows.
std::optional<std::string> FindFile(absl::string_view name, const std::filesystem::path& folder);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_MTL_FILE_H_
