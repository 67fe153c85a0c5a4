#include "client/mesh/scene_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>

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

// `number`: of the part.
absl::Status AppendMesh(const aiMesh& part, uint32_t number, const Affine& to_world, Mesh& mesh) {
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
  if (part.mColors[0] != nullptr && mesh.colors.size() == base) {
    for (unsigned v = 0; v < part.mNumVertices; ++v) mesh.colors.push_back(ToColor(part.mColors[0][v]));
  }
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
    if (auto status = AppendMesh(part, number, to_world, mesh); !status.ok()) return status;
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
