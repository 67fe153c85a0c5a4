// One mesh in several parts at once, over one Client. It is uploaded once, and the parts refer to it.
#include <latvox/client.h>

#include <future>
#include <vector>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 5) return example::Usage("shards ADDRESS MESH.drc RESOLUTION PARTS");
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());
  const auto bytes = example::Read(argv[2]);
  if (!bytes.ok()) return example::Fail(bytes.status());
  const auto mesh = client->PutMesh(*bytes);
  if (!mesh.ok()) return example::Fail(mesh.status());

  const uint32_t count = example::Number(argv[4]);
  const auto run = [&](uint32_t index) {
    lv::VoxelizeRequest request;
    request.resolution = example::Number(argv[3]);
    request.shard = lv::Shard{index, count};
    return client->Voxelize(request, *mesh, {.on_bricks = [](const lv::BrickBatch&) { return absl::OkStatus(); }});
  };
  std::vector<std::future<absl::StatusOr<lv::Summary>>> parts;
  for (uint32_t index = 0; index < count; ++index) parts.push_back(std::async(std::launch::async, run, index));
  uint64_t voxels = 0;
  for (auto& part : parts) {
    const auto summary = part.get();
    if (!summary.ok()) return example::Fail(summary.status());
    voxels += summary->voxels;
  }
  std::printf("%llu voxels in %u parts\n", static_cast<unsigned long long>(voxels), count);
}
