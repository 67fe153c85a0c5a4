#include "client/mesh_files/mesh_file.h"

#include <filesystem>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/printable.h"
#include "client/mesh_files/draco_file.h"
#include "client/mesh_files/gltf_file.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/obj_file.h"
#include "client/mesh_files/ply_file.h"
#include "client/mesh_files/stl_file.h"
#include "client/mesh_files/three_mf_file.h"

namespace latvox::client {
namespace {

// `folder` is that of the files that a glTF refers to.
absl::StatusOr<Mesh> Parse(absl::string_view bytes, MeshFormat format, const std::filesystem::path& folder) {
  switch (format) {
    case MeshFormat::kDraco:
      return ParseDraco(bytes);
    case MeshFormat::kObj:
      return ParseObj(WithoutByteOrderMark(bytes));
    case MeshFormat::kPly:
      return ParsePly(WithoutByteOrderMark(bytes));
    case MeshFormat::kThreeMf:
      return Parse3mf(bytes);
    case MeshFormat::kStl:
      return ParseStl(WithoutByteOrderMark(bytes));
    case MeshFormat::kGlb:
    case MeshFormat::kGltf:
      break;
  }
  return ParseGltf(WithoutByteOrderMark(bytes), folder);
}

// Puts the path before an error, and makes the file's own words printable. A mesh without triangles is an error, too.
absl::StatusOr<Mesh> Named(const std::string& path, absl::StatusOr<Mesh> mesh) {
  const std::string name = NameOfInput(path);
  if (!mesh.ok()) {
    return absl::Status(mesh.status().code(), absl::StrCat(name, ": ", Printable(mesh.status().message())));
  }
  for (Warning& warning : mesh->warnings) warning.message = Printable(warning.message);
  if (mesh->triangles.empty()) return absl::InvalidArgumentError(absl::StrCat(name, ": the mesh has no triangles"));
  return mesh;
}

std::string Known() {
  const auto name = [](std::string* out, const auto& format) { absl::StrAppend(out, ".", format.first); };
  return absl::StrJoin(MeshFormats(), " ", name);
}

}  // namespace

absl::StatusOr<Mesh> ReadMesh(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory"));
  }
  const auto format = FormatOfPath(path);
  if (!format) {
    return absl::InvalidArgumentError(absl::StrCat(
        path, ": mesh format \"", std::filesystem::path(path).extension().string(), "\" is not one of ", Known()));
  }
  const auto bytes = ReadBytes(path);
  if (!bytes.ok()) return bytes.status();
  return Named(path, Parse(*bytes, *format, std::filesystem::path(path).parent_path()));
}

absl::StatusOr<Mesh> ParseMeshFile(const std::string& path, absl::string_view bytes, MeshFormat format) {
  return Named(path, Parse(bytes, format, ""));
}

}  // namespace latvox::client
