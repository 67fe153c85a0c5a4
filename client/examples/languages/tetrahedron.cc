#include <latvox/client.h>
#include <latvox/mesh/encode_raw_mesh.h>

#include <cstdio>

namespace lv = latvox::client;

int Fail(const absl::Status& status) { return std::fprintf(stderr, "%s\n", status.ToString().c_str()), 1; }

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: tetrahedron ADDRESS\n"), 2;
  const lv::TriangleMesh tetrahedron = {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                        .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const auto mesh = lv::EncodeRawMesh(tetrahedron);
  if (!mesh.ok()) return Fail(mesh.status());
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return Fail(client.status());
  lv::VoxelizeRequest request = {.lattice = lv::NamedLattice::kBcc, .resolution = 32};
  request.raw_mesh = mesh->layout;
  const auto all = client->VoxelizeAll(request, mesh->bytes);
  if (!all.ok()) return Fail(all.status());
  std::printf("%llu voxels, digest %s\n", static_cast<unsigned long long>(all->summary.voxels),
              all->summary.certificate.digest.c_str());
}
