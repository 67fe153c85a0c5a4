// A .vdb file by the grid library: any lattice is the grid's transform, and the certificate its metadata.
// Usage: to_vdb ADDRESS MESH.drc RESOLUTION OUT.vdb
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "client/client.h"
#include "client/grid/voxel_grid.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 5) return std::fputs("to_vdb ADDRESS MESH.drc RESOLUTION OUT.vdb\n", stderr), 2;
  std::ifstream file(argv[2], std::ios::binary);
  const std::string mesh{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return std::fprintf(stderr, "%s\n", client.status().ToString().c_str()), 1;

  lv::VoxelizeRequest request;
  request.lattice = lv::NamedLattice::kFcc;
  request.separability = 2;
  request.resolution = static_cast<uint32_t>(std::atoi(argv[3]));
  std::optional<lv::VoxelGrid> grid;
  const auto begin = [&](const lv::Accepted& accepted) { return grid.emplace(accepted.grid), absl::OkStatus(); };
  const auto add = [&](const lv::BrickBatch& batch) { return grid->Add(batch); };
  const auto summary = client->Voxelize(request, mesh, {.on_accepted = begin, .on_bricks = add});
  if (!summary.ok()) return std::fprintf(stderr, "%s\n", summary.status().ToString().c_str()), 1;
  grid->SetCertificate(summary->certificate);
  const absl::Status written = grid->Write(argv[4]);
  if (!written.ok()) return std::fprintf(stderr, "%s\n", written.ToString().c_str()), 1;
  std::printf("%llu voxels\n", static_cast<unsigned long long>(grid->CountActiveVoxels()));
}
