#include "client/mesh/scene_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/affine.h"

namespace latvox::client {
namespace {

Affine ToAffine(const aiMatrix4x4& m) {
  return {{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}};
}

absl::Status AppendMesh(const aiMesh& part, const Affine& to_world, Mesh& mesh) {
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
  for (unsigned n = 0; n < node.mNumMeshes; ++n) {
    if (auto status = AppendMesh(*scene.mMeshes[node.mMeshes[n]], to_world, mesh); !status.ok()) return status;
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
