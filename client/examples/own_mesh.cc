// A mesh of your own instead of a file: sent as plain arrays, and voxelized.
#include <latvox/client.h>
#include <latvox/mesh/encode_raw_mesh.h>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 3) return example::Usage("own_mesh ADDRESS RESOLUTION");
  const lv::TriangleMesh octahedron = {
      .positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      .triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  const auto mesh = lv::EncodeRawMesh(octahedron);
  if (!mesh.ok()) return example::Fail(mesh.status());
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());

  lv::VoxelizeRequest request;
  request.resolution = example::Number(argv[2]);
  request.raw_mesh = mesh->layout;
  const auto all = client->VoxelizeAll(request, mesh->bytes);
  if (!all.ok()) return example::Fail(all.status());
  std::printf("%llu voxels, digest %s\n", static_cast<unsigned long long>(all->summary.voxels),
              all->summary.certificate.digest.c_str());
}
