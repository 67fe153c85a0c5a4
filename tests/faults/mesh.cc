// Meshes as .drc files, by the SDK's own encoder.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include "client/mesh/mesh_encoder.h"
#include "tests/bench/meshes.h"
#include "tests/faults/commands.h"

namespace latvox::faults {
namespace {

struct MeshOptions {
  std::string mesh, out;
  int subdivide = 0;
  int bits = 14;
};

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "latvox_faults: %s\n", std::string{status.message()}.c_str());
  return 2;
}

int WriteMesh(const MeshOptions& options) {
  auto mesh = MeshNamed(options.mesh);
  if (!mesh.ok()) return Fail(mesh.status());
  TriangleMesh fine = Subdivided(*std::move(mesh), options.subdivide);
  client::Mesh whole{.positions = {}, .triangles = fine.triangles};
  for (const auto& v : fine.vertices) whole.positions.push_back({v[0], v[1], v[2]});
  const auto encoded = client::EncodeMesh(whole, options.bits);
  if (!encoded.ok()) return Fail(encoded.status());
  std::ofstream file(options.out, std::ios::binary);
  file << encoded->drc << std::flush;
  return file ? 0 : Fail(absl::UnknownError("cannot write " + options.out));
}

}  // namespace

void AddMesh(CLI::App& program, Command& run) {
  const auto options = std::make_shared<MeshOptions>();
  CLI::App& command = *program.add_subcommand("mesh", "Encodes a mesh, as latvox_bench names it");
  command.add_option("mesh", options->mesh)->required();
  command.add_option("out", options->out)->required();
  command.add_option("--subdivide", options->subdivide, "How often each triangle is divided into four");
  command.add_option("--bits", options->bits, "Bits of position quantization; 0: none");
  command.callback([options, &run] { run = [options] { return WriteMesh(*options); }; });
}

}  // namespace latvox::faults
