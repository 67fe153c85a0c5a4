#include "client/mesh/scene_file.h"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh_attributes.h"

namespace latvox::client {
namespace {

Affine ToAffine(const aiMatrix4x4& m) {
  return {{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}};
}

// As bytes; beyond 0 and 1 glTF has no colors.
Color ToColor(const aiColor4D& color) {
  const auto byte = [](float x) {
    return static_cast<uint8_t>(std::nearbyint(std::min(std::max(0.0F, x), 1.0F) * 255));
  };
  return {byte(color.r), byte(color.g), byte(color.b)};
}

// The color that all of a part has: the factor of its material, where that is in the file and has no texture, which
// would change it. Where there is none, nothing; and why in no_color, if there is something that is not read.
std::optional<Color> BaseColorOf(const aiScene& scene, const aiMesh& part, std::string& no_color) {
  if (part.mMaterialIndex + 1 >= scene.mNumMaterials) return std::nullopt;  // assimp's own, for what has none
  const aiMaterial& material = *scene.mMaterials[part.mMaterialIndex];
  if (material.GetTextureCount(aiTextureType_BASE_COLOR) + material.GetTextureCount(aiTextureType_DIFFUSE) > 0) {
    no_color =
        absl::StrCat("material \"", material.GetName().C_Str(), "\" has a texture, and textures are not sampled");
    return std::nullopt;
  }
  aiColor4D factor;
  if (material.Get(AI_MATKEY_COLOR_DIFFUSE, factor) != aiReturn_SUCCESS) return std::nullopt;
  return ToColor(factor);
}

void AppendColors(const aiScene& scene, const aiMesh& part, Mesh& mesh) {
  if (part.mColors[0] != nullptr) {
    for (unsigned v = 0; v < part.mNumVertices; ++v) mesh.colors.push_back(ToColor(part.mColors[0][v]));
  } else if (const auto color = BaseColorOf(scene, part, mesh.no_color)) {
    mesh.colors.insert(mesh.colors.end(), part.mNumVertices, *color);
  }
}

// `number`: of the part.
absl::Status AppendMesh(const aiScene& scene, const aiMesh& part, uint32_t number, const Affine& to_world, Mesh& mesh) {
  const size_t base = mesh.positions.size();
  if (base + part.mNumVertices > UINT32_MAX) {
    return absl::InvalidArgumentError(absl::StrCat("more than ", UINT32_MAX, " vertices"));
  }
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const aiVector3D& vertex = part.mVertices[v];
    const Vec3f position = Apply(to_world, {vertex.x, vertex.y, vertex.z});
    for (const float coordinate : position) {
      if (!std::isfinite(coordinate))
        return absl::InvalidArgumentError(absl::StrCat("mesh ", part.mName.C_Str(), ": vertex ", v, " is not finite"));
    }
    mesh.positions.push_back(position);
  }
  if (mesh.colors.size() == base) AppendColors(scene, part, mesh);
  BeginStretch(number, part.mMaterialIndex, mesh);
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) {
      ++mesh.skipped;
      continue;
    }
    std::array<uint32_t, 3> triangle{};
    for (unsigned n = 0; n < 3; ++n) {
      if (face.mIndices[n] >= part.mNumVertices) {
        return absl::InvalidArgumentError(absl::StrCat("mesh ", part.mName.C_Str(), ": vertex index ", face.mIndices[n],
                                                       " of face ", f, " exceeds the ", part.mNumVertices,
                                                       " vertices"));
      }
      triangle[n] = static_cast<uint32_t>(base + face.mIndices[n]);
    }
    mesh.triangles.push_back(triangle);
  }
  return absl::OkStatus();
}

absl::Status AppendNode(const aiScene& scene, const aiNode& node, const Affine& parent, Mesh& mesh) {
  const Affine to_world = parent * ToAffine(node.mTransformation);
  const uint32_t number = NextPart(mesh);
  for (unsigned n = 0; n < node.mNumMeshes; ++n) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[n]];
    if (auto status = AppendMesh(scene, part, number, to_world, mesh); !status.ok()) return status;
  }
  for (unsigned n = 0; n < node.mNumChildren; ++n) {
    if (auto status = AppendNode(scene, *node.mChildren[n], to_world, mesh); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// What `read` makes of a file. No other post-processing than triangulation: joining or validating steps move, merge or
// drop what the file says.
template <class Read>
absl::StatusOr<Mesh> ReadScene(const Read& read) try {
  Assimp::Importer importer;
  const aiScene* scene = read(importer, aiProcess_Triangulate);
  if (scene == nullptr) {
    const std::string reason(absl::StripAsciiWhitespace(importer.GetErrorString()));
    return absl::InvalidArgumentError(absl::StrCat("cannot be read as a mesh (", reason, ")"));
  }
  Mesh mesh;
  mesh.materials = scene->mNumMaterials;
  if (scene->mRootNode != nullptr) {
    if (auto status = AppendNode(*scene, *scene->mRootNode, kIdentity, mesh); !status.ok()) return status;
  }
  return mesh;
} catch (const std::exception& error) {
  return absl::InvalidArgumentError(absl::StrCat("cannot be read as a mesh (", error.what(), ")"));
}

}  // namespace

absl::StatusOr<Mesh> ReadSceneFile(const std::string& path) {
  return ReadScene([&](Assimp::Importer& importer, unsigned flags) { return importer.ReadFile(path, flags); });
}

absl::StatusOr<Mesh> ParseScene(absl::string_view bytes, const std::string& extension) {
  return ReadScene([&](Assimp::Importer& importer, unsigned flags) {
    return importer.ReadFileFromMemory(bytes.data(), bytes.size(), flags, extension.c_str());
  });
}

}  // namespace latvox::client
