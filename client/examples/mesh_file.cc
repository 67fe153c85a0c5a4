// From a mesh file to its voxels, without a running server: prints i, j and k of each, and draws the middle layer.
#include <latvox/client.h>
#include <latvox/dense.h>
#include <latvox/for_each_voxel.h>
#include <latvox/mesh/encode_raw_mesh.h>
#include <latvox/mesh_files/read_mesh_file.h>

#include "example.h"

namespace lv = latvox::client;

absl::StatusOr<lv::Voxelization> VoxelizeFile(const std::string& path, uint32_t resolution) {
  const auto mesh = lv::ReadMeshFile(path);
  if (!mesh.ok()) return mesh.status();
  const auto raw = lv::EncodeRawMesh(*mesh);
  if (!raw.ok()) return raw.status();
  const auto client = lv::Client::StartPrivate();
  if (!client.ok()) return client.status();
  lv::VoxelizeRequest request;
  request.resolution = resolution;
  request.raw_mesh = raw->layout;
  return client->VoxelizeAll(request, raw->bytes);
}

void DrawMiddleLayer(const lv::DenseVoxels& dense) {
  for (size_t j = dense.shape[1]; j-- > 0;) {
    for (size_t i = 0; i < dense.shape[0]; ++i) {
      const size_t element = i * dense.strides[0] + j * dense.strides[1] + dense.shape[2] / 2 * dense.strides[2];
      std::fputc(dense.voxels[element] ? '#' : '.', stderr);
    }
    std::fputc('\n', stderr);
  }
}

int main(int argc, char** argv) {
  if (argc != 3) return example::Usage("mesh_file MESH RESOLUTION");
  const auto all = VoxelizeFile(argv[1], example::Number(argv[2]));
  if (!all.ok()) return example::Fail(all.status());
  lv::ForEachVoxel(*all,
                   [](const lv::Voxel& voxel) { std::printf("%d,%d,%d\n", voxel.ijk[0], voxel.ijk[1], voxel.ijk[2]); });
  const auto dense = lv::ToDense(*all);
  if (!dense.ok()) return example::Fail(dense.status());
  DrawMiddleLayer(*dense);
}
