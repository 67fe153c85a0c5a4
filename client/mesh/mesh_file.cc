#include "client/mesh/mesh_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/obj_file.h"
#include "client/mesh/ply_file.h"
#include "client/mesh/scene_file.h"

namespace latvox::client {
namespace {

std::string Extension(const std::string& path) {
  return absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
}

absl::StatusOr<Mesh> Read(const std::string& path, const std::string& extension) {
  if (extension == ".obj" || extension == ".ply") {
    const auto bytes = ReadBytes(path);
    if (!bytes.ok()) return bytes.status();
    return extension == ".obj" ? ParseObj(*bytes) : ParsePly(*bytes);
  }
  if (extension == ".stl" || extension == ".glb" || extension == ".gltf") {
    return ReadSceneFile(path);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("mesh format \"", extension, "\" is not one of .drc .obj .ply .stl .glb .gltf"));
}

}  // namespace

bool IsDracoFile(const std::string& path) { return Extension(path) == ".drc"; }

bool MayReferToFiles(const std::string& path) { return Extension(path) == ".glb" || Extension(path) == ".gltf"; }

absl::StatusOr<std::string> ReadBytes(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory"));
  }
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be read (", std::strerror(errno), ")"));
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (file.bad()) return absl::InvalidArgumentError(absl::StrCat(path, ": cannot be read to its end"));
  std::string text = std::move(bytes).str();
  if (text.empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": is empty"));
  return text;
}

absl::StatusOr<Mesh> ReadMeshFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  absl::StatusOr<Mesh> mesh = Read(path, Extension(path));
  if (!mesh.ok()) {
    const absl::string_view message = mesh.status().message();
    const bool named = message.substr(0, path.size()) == path;
    return named ? mesh.status() : absl::Status(mesh.status().code(), absl::StrCat(path, ": ", message));
  }
  if (mesh->triangles.empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": the mesh has no triangles"));
  return mesh;
}

}  // namespace latvox::client
