#include "client/mesh_files/mesh_file.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/file_error.h"
#include "client/internal/printable.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/decode.h"
#include "client/mesh_files/draco_file.h"
#include "client/mesh_files/gltf_file.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/obj_file.h"
#include "client/mesh_files/off_file.h"
#include "client/mesh_files/ply_file.h"
#include "client/mesh_files/stl_file.h"
#include "client/mesh_files/three_mf_file.h"

namespace latvox::client {
namespace {

// `folder` is that of the files that a glTF or an OBJ refers to.
absl::StatusOr<Mesh> Parse(absl::string_view bytes, MeshFormat format, const std::filesystem::path& folder,
                           const ParseOptions& options) {
  switch (format) {
    case MeshFormat::kDraco:
      return ParseDraco(bytes);
    case MeshFormat::kObj:
      return ParseObj(WithoutByteOrderMark(bytes), options, folder);
    case MeshFormat::kPly:
      return ParsePly(WithoutByteOrderMark(bytes), options);
    case MeshFormat::kThreeMf:
      return Parse3mf(bytes, options);
    case MeshFormat::kStl:
      return ParseStl(WithoutByteOrderMark(bytes), options);
    case MeshFormat::kOff:
      return ParseOff(WithoutByteOrderMark(bytes), options);
    case MeshFormat::kGlb:
    case MeshFormat::kGltf:
      break;
  }
  return ParseGltf(WithoutByteOrderMark(bytes), folder, options);
}

// Puts the path before an error, and makes the file's own words printable. A mesh without triangles is an error, too.
absl::StatusOr<Mesh> Named(const std::string& path, absl::StatusOr<Mesh> mesh) {
  const std::string name = NameOfInput(path);
  if (!mesh.ok()) {
    return absl::Status(mesh.status().code(), absl::StrCat(name, ": ", Printable(mesh.status().message())));
  }
  for (Warning& warning : mesh->warnings) warning.message = Printable(warning.message);
  const auto tells = [](const Warning& warning) { return warning.code == "SKIPPED_ELEMENTS"; };
  if (mesh->skipped > 0 && std::none_of(mesh->warnings.begin(), mesh->warnings.end(), tells)) {
    mesh->warnings.push_back(
        {"SKIPPED_ELEMENTS", absl::StrCat(mesh->skipped, " elements without a surface are left out")});
  }
  if (mesh->triangles.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(name, ": the mesh has no triangles", LeftOut(*mesh)));
  }
  return mesh;
}

std::string Known() {
  const auto name = [](std::string* out, const auto& format) { absl::StrAppend(out, ".", format.first); };
  return absl::StrJoin(MeshFormats(), " ", name);
}

std::string NameOf(MeshFormat format) {
  for (const auto& [name, known] : MeshFormats()) {
    if (known == format) return name;
  }
  return "";
}

// Decodes the bytes and parses them. Without `is_sure`, bytes that begin like another format are read as that.
absl::StatusOr<Mesh> ParseBytes(const std::string& path, std::string bytes, MeshFormat format, bool is_sure,
                                const std::filesystem::path& folder, const ParseOptions& options) {
  std::vector<Warning> warnings;
  const auto decoded = Decode(std::move(bytes), warnings);
  if (!decoded.ok()) return Named(path, decoded.status());
  const auto found = is_sure ? format : FormatOfBytes(*decoded).value_or(format);
  const auto is_gltf = [](MeshFormat one) { return one == MeshFormat::kGlb || one == MeshFormat::kGltf; };
  if (found != format && !(is_gltf(found) && is_gltf(format))) {
    warnings.push_back({"FORMAT_MISMATCH", absl::StrCat("is named .", NameOf(format), ", and is read as .",
                                                        NameOf(found), ", by its first bytes")});
  }
  auto mesh = Named(path, Parse(*decoded, found, folder, options));
  if (mesh.ok()) mesh->warnings.insert(mesh->warnings.begin(), warnings.begin(), warnings.end());
  return mesh;
}

}  // namespace

absl::StatusOr<Mesh> ReadMesh(const std::string& path, const ParseOptions& options) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    if (!absl::StrContains(path, "://")) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
    return absl::InvalidArgumentError(absl::StrCat(
        path, ": is a URL; latvox reads files, and standard input as -: download it, or pipe it into latvox"));
  }
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory"));
  }
  const auto format = FormatOfPath(path);
  if (!format) {
    const std::string extension = std::filesystem::path(path).extension().string();
    const std::string text = absl::StrCat(path, ": mesh format \"", extension, "\" is not one of ", Known());
    return WithFile(absl::InvalidArgumentError(text), "mesh", path, Known());
  }
  auto bytes = ReadBytes(path);
  if (!bytes.ok()) return bytes.status();
  return ParseBytes(path, *std::move(bytes), *format, false, std::filesystem::path(path).parent_path(), options);
}

absl::StatusOr<Mesh> ParseMeshFile(const std::string& path, absl::string_view bytes, MeshFormat format,
                                   const ParseOptions& options) {
  return ParseBytes(path, std::string(bytes), format, true, "", options);
}

}  // namespace latvox::client
