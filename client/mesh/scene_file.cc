#include "client/mesh/scene_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

// Row-major affine map in double, of which the fourth row is (0, 0, 0, 1).
using Affine = std::array<std::array<double, 4>, 3>;

constexpr Affine kIdentity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Affine operator*(const Affine& outer, const aiMatrix4x4& inner) {
  Affine out{};
  for (size_t r = 0; r < 3; ++r) {
    for (unsigned c = 0; c < 4; ++c) {
      out[r][c] = c == 3 ? outer[r][3] : 0;
      for (unsigned m = 0; m < 3; ++m) out[r][c] += outer[r][m] * double{inner[m][c]};
    }
  }
  return out;
}

Vec3f Apply(const Affine& map, const aiVector3D& v) {
  // Untouched, so that positions without a transform keep their bits.
  if (map == kIdentity) return {v.x, v.y, v.z};
  Vec3f out;
  for (size_t r = 0; r < 3; ++r) {
    out[r] =
        static_cast<float>(map[r][0] * double{v.x} + map[r][1] * double{v.y} + map[r][2] * double{v.z} + map[r][3]);
  }
  return out;
}

absl::Status AppendMesh(const aiMesh& part, const Affine& to_world, Mesh& mesh) {
  const size_t base = mesh.positions.size();
  if (base + part.mNumVertices > UINT32_MAX) {
    return absl::InvalidArgumentError(absl::StrCat("more than ", UINT32_MAX, " vertices"));
  }
  for (unsigned v = 0; v < part.mNumVertices; ++v) {
    const Vec3f position = Apply(to_world, part.mVertices[v]);
    for (const float coordinate : position) {
      if (!std::isfinite(coordinate))
        return absl::InvalidArgumentError(absl::StrCat("vertex ", base + v, " is not finite"));
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
        return absl::InvalidArgumentError(absl::StrCat("vertex index ", face.mIndices[n], " of face ", f,
                                                       " exceeds the ", part.mNumVertices, " vertices"));
      }
      triangle[n] = static_cast<uint32_t>(base + face.mIndices[n]);
    }
    mesh.triangles.push_back(triangle);
  }
  return absl::OkStatus();
}

absl::Status AppendNode(const aiScene& scene, const aiNode& node, const Affine& parent, Mesh& mesh) {
  const Affine to_world = parent * node.mTransformation;
  for (unsigned n = 0; n < node.mNumMeshes; ++n) {
    if (auto status = AppendMesh(*scene.mMeshes[node.mMeshes[n]], to_world, mesh); !status.ok()) return status;
  }
  for (unsigned n = 0; n < node.mNumChildren; ++n) {
    if (auto status = AppendNode(scene, *node.mChildren[n], to_world, mesh); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

// No other post-processing than triangulation: joining or validating steps move, merge or drop what the file says.
absl::StatusOr<Mesh> ReadSceneFile(const std::string& path) try {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
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

}  // namespace latvox::client
