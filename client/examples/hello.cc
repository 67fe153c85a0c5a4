// The shortest way from a mesh to voxels: all of them, in memory. Make a mesh first:
//   latvox encode /usr/share/glmark2/models/bunny.obj -o bunny.drc
#include <latvox/client.h>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 4) return example::Usage("hello ADDRESS MESH.drc RESOLUTION");
  const auto mesh = example::Read(argv[2]);
  if (!mesh.ok()) return example::Fail(mesh.status());
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());

  lv::VoxelizeRequest request;
  request.lattice = lv::NamedLattice::kBcc;
  request.resolution = example::Number(argv[3]);
  const auto all = client->VoxelizeAll(request, *mesh);
  if (!all.ok()) return example::Fail(all.status());
  std::printf("%llu voxels in %zu bricks, digest %s\n", static_cast<unsigned long long>(all->summary.voxels),
              all->bricks.size(), all->summary.certificate.digest.c_str());
}
