// Reads the stream into a structure of your own, a height for each column, and leaves it early.
#include <latvox/client.h>
#include <latvox/for_each_voxel.h>

#include <algorithm>
#include <map>
#include <utility>

#include "example.h"

namespace lv = latvox::client;

using Heights = std::map<std::pair<int32_t, int32_t>, int32_t>;  // of the columns (i, j): the highest k

uint64_t Add(const lv::Brick& brick, Heights& heights) {
  uint64_t voxels = 0;
  lv::ForEachVoxel(brick, [&](const lv::Vec3i& ijk) {
    const auto column = heights.try_emplace({ijk[0], ijk[1]}, ijk[2]).first;
    column->second = std::max(column->second, ijk[2]);
    ++voxels;
  });
  return voxels;
}

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) return example::Usage("structure ADDRESS MESH.drc RESOLUTION [ENOUGH_VOXELS]");
  auto mesh = example::Read(argv[2]);
  if (!mesh.ok()) return example::Fail(mesh.status());
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());

  lv::VoxelizeRequest request;
  request.resolution = example::Number(argv[3]);
  const uint64_t enough = argc == 5 ? example::Number(argv[4]) : UINT64_MAX;
  uint64_t voxels = 0;
  Heights heights;
  lv::BrickStream stream = client->Stream(request, std::move(*mesh));
  for (const absl::StatusOr<lv::BrickBatch>& batch : stream) {
    if (!batch.ok()) return example::Fail(batch.status());
    for (const lv::Brick& brick : batch->bricks) voxels += Add(brick, heights);
    if (voxels >= enough) break;  // the stream's end cancels the rest
  }
  std::printf("%s%llu voxels over %zu columns\n", stream.summary() ? "" : "at least ",
              static_cast<unsigned long long>(voxels), heights.size());
}
