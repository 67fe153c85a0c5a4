#include "client/mesh_files/mesh_source.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/file_error.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/decode.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_join.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

constexpr char kOwnAttributes[] =
    "; attributes of a .drc count only if it is sent as it is: alone, without --up-axis and --scale";

Affine ToWorld(const MeshSource& input) {
  constexpr Affine kFromX = {{{0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}}};
  constexpr Affine kFromY = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
  const Affine& turn = input.up == UpAxis::kX ? kFromX : input.up == UpAxis::kY ? kFromY : kIdentity;
  return Scaling(input.scale) * turn;
}

absl::StatusOr<MeshFormat> FormatOf(const std::string& path, const MeshSource& input, absl::string_view bytes) {
  if (input.format) return *input.format;
  if (const auto format = FormatOfBytes(bytes)) return *format;
  return absl::InvalidArgumentError(
      absl::StrCat(NameOfInput(path), ": does not begin like any mesh format; name the format with --input-format"));
}

absl::StatusOr<MeshOrDraco> ReadOne(const std::string& path, const MeshSource& input, bool keep_draco) {
  const bool standard_input = path == kStandardInput;
  const auto by_name = FormatOfPath(path);
  if (!standard_input && !(keep_draco && by_name == MeshFormat::kDraco) && (!input.format || input.format == by_name)) {
    return ReadMesh(path, {input.skip_bad, input.base_colors});
  }
  auto bytes = standard_input ? ReadStandardInput("a mesh") : ReadBytes(path);
  std::vector<Warning> warnings;
  if (bytes.ok()) bytes = Decode(*std::move(bytes), warnings);
  if (!bytes.ok()) return bytes.status();
  const auto format = standard_input || input.format ? FormatOf(path, input, *bytes) : *by_name;
  if (!format.ok()) return format.status();
  if (keep_draco && *format == MeshFormat::kDraco) return *std::move(bytes);
  return ParseMeshFile(path, *bytes, *format, {input.skip_bad, input.base_colors});
}

// If there are several files, the parts of a file without names of parts are named like the file.
void NameAfterFile(const std::string& path, Mesh& mesh) {
  if (path == kStandardInput || !mesh.part_names.empty()) return;
  const std::string name = std::filesystem::path(path).filename().string();
  for (uint32_t part = 0; part < NextPart(mesh); ++part) SetName(part, name, mesh.part_names);
}

// Puts the path before the names of the images.
void NameImages(const std::string& path, Mesh& mesh) {
  std::set<EncodedImage*> named;
  for (const BaseColor& color : mesh.base_colors.all) {
    if (color.image == nullptr || !named.insert(color.image.get()).second) continue;
    color.image->name = absl::StrCat(NameOfInput(path), ": ", color.image->name);
  }
}

// Returns the error with another text.
absl::Status Reworded(const absl::Status& error, const std::string& text) {
  absl::Status reworded(error.code(), text);
  SetErrorDetails(GetErrorDetails(error), reworded);
  return reworded;
}

}  // namespace

std::string NameOf(const MeshSource& input) {
  const auto name = [](std::string* out, const std::string& path) { *out += NameOfInput(path); };
  return absl::StrJoin(input.paths, " + ", name);
}

bool MayReferToFiles(const MeshSource& input) {
  return std::any_of(input.paths.begin(), input.paths.end(), [&](const std::string& path) {
    const auto format = input.format ? input.format : FormatOfPath(path);
    // Colors and textures are in .mtl files.
    const bool has_materials = format == MeshFormat::kObj && (!input.attributes.empty() || input.base_colors);
    return format == MeshFormat::kGlb || format == MeshFormat::kGltf || has_materials;
  });
}

absl::StatusOr<MeshOrDraco> ReadMeshSource(const MeshSource& input) {
  const Affine to_world = ToWorld(input);
  const bool keep_draco = input.paths.size() == 1 && to_world == kIdentity;
  Mesh joined;
  for (const std::string& path : input.paths) {
    auto read = ReadOne(path, input, keep_draco);
    if (!read.ok()) return WithFile(read.status(), "mesh", path);
    if (std::holds_alternative<std::string>(*read)) return read;
    for (Warning& warning : std::get<Mesh>(*read).warnings) {
      warning.message = absl::StrCat(NameOfInput(path), ": ", warning.message);
    }
    NameImages(path, std::get<Mesh>(*read));
    absl::Status status = CheckHas(input.attributes, std::get<Mesh>(*read));
    if (!status.ok() && (input.format ? input.format : FormatOfPath(path)) == MeshFormat::kDraco) {
      status = Reworded(status, absl::StrCat(status.message(), kOwnAttributes));
    }
    if (input.paths.size() > 1) NameAfterFile(path, std::get<Mesh>(*read));
    if (status.ok()) status = Append(std::get<Mesh>(*std::move(read)), to_world, joined);
    if (!status.ok()) {
      return Reworded(status, absl::StrCat(NameOfInput(path), ": ", status.message()));
    }
  }
  return joined;
}

absl::Status PlaceMesh(const MeshSource& input, Mesh& mesh) {
  if (absl::Status status = CheckHas(input.attributes, mesh); !status.ok()) return status;
  return Transform(ToWorld(input), mesh);
}

}  // namespace latvox::client
