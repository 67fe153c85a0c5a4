// Writes a .vdb file with the grid library: the lattice is the grid's transform, and the certificate its metadata.
#include <latvox/client.h>
#include <latvox/grid/voxel_grid.h>

#include <optional>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 5) return example::Usage("to_vdb ADDRESS MESH.drc RESOLUTION OUT.vdb");
  const auto mesh = example::Read(argv[2]);
  if (!mesh.ok()) return example::Fail(mesh.status());
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());

  lv::VoxelizeRequest request;
  request.lattice = lv::NamedLattice::kFcc;
  request.separability = 2;
  request.resolution = example::Number(argv[3]);
  std::optional<lv::VoxelGrid> grid;
  const auto begin = [&](const lv::Accepted& accepted) { return grid.emplace(accepted.grid), absl::OkStatus(); };
  const auto add = [&](const lv::BrickBatch& batch) { return grid->Add(batch); };
  const auto summary = client->Voxelize(request, *mesh, {.on_accepted = begin, .on_bricks = add});
  if (!summary.ok()) return example::Fail(summary.status());
  grid->SetCertificate(summary->certificate);
  if (const absl::Status written = grid->Write(argv[4]); !written.ok()) return example::Fail(written);
  std::printf("%llu voxels\n", static_cast<unsigned long long>(grid->CountActiveVoxels()));
}
