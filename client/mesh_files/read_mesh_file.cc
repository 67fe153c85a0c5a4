#include "latvox/mesh_files/read_mesh_file.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "client/internal/printable.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_source.h"

namespace latvox::client {
namespace {

bool IsPart0(const Stretch& stretch) { return stretch.part == 0; }
bool HasMaterial(const Stretch& stretch) { return stretch.material.has_value(); }

// Returns one number for each triangle.
template <class NumberOf>
std::vector<uint32_t> ForEachTriangle(const Mesh& mesh, const NumberOf& number_of) {
  std::vector<uint32_t> numbers;
  numbers.reserve(mesh.triangles.size());
  for (size_t s = 0; s < mesh.stretches.size(); ++s) {
    const size_t end = s + 1 < mesh.stretches.size() ? mesh.stretches[s + 1].first : mesh.triangles.size();
    numbers.resize(end, number_of(mesh.stretches[s]));
  }
  return numbers;
}

TriangleMesh ToPublic(Mesh mesh) {
  TriangleMesh out;
  out.positions.reserve(mesh.positions.size());
  for (const Vec3d& p : mesh.positions) out.positions.push_back({p[0], p[1], p[2]});
  const auto& stretches = mesh.stretches;
  if (!std::all_of(stretches.begin(), stretches.end(), IsPart0)) {
    out.parts = ForEachTriangle(mesh, [](const Stretch& stretch) { return stretch.part; });
  }
  if (!stretches.empty() && std::all_of(stretches.begin(), stretches.end(), HasMaterial)) {
    out.materials = ForEachTriangle(mesh, [](const Stretch& stretch) { return *stretch.material; });
  }
  if (mesh.colors.size() == mesh.positions.size()) out.colors = std::move(mesh.colors);
  out.triangles = std::move(mesh.triangles);
  out.skipped = mesh.skipped;
  out.warnings = std::move(mesh.warnings);
  return out;
}

}  // namespace

absl::StatusOr<TriangleMesh> ReadMeshFile(const std::string& path, const ReadMeshOptions& options) {
  auto read = ReadMeshSource({.paths = {path},
                              .format = options.format,
                              .up = options.up,
                              .scale = options.scale,
                              .skip_bad = options.skip_bad});
  if (!read.ok()) return PrintableStatus(read.status());
  if (auto* mesh = std::get_if<Mesh>(&*read)) return ToPublic(std::move(*mesh));
  auto decoded = ParseMeshFile(path, std::get<std::string>(*read), MeshFormat::kDraco);
  if (!decoded.ok()) return PrintableStatus(decoded.status());
  return ToPublic(*std::move(decoded));
}

}  // namespace latvox::client
