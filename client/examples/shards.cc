// One mesh in several parts at once, over one Client: the first call uploads the mesh, the others refer to it.
// Usage: shards ADDRESS[,ADDRESS...] MESH.drc RESOLUTION PARTS
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "client/client.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 5) return std::fputs("shards ADDRESS MESH.drc RESOLUTION PARTS\n", stderr), 2;
  std::ifstream file(argv[2], std::ios::binary);
  const std::string mesh{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto parts = static_cast<uint32_t>(std::atoi(argv[4]));
  auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return std::fprintf(stderr, "%s\n", client.status().ToString().c_str()), 1;

  std::atomic<uint64_t> voxels = 0;
  std::atomic<bool> failed = false;
  const auto run = [&](uint32_t index) {
    lv::VoxelizeRequest request;
    request.resolution = static_cast<uint32_t>(std::atoi(argv[3]));
    request.shard = lv::Shard{index, parts};
    const auto summary = client->Voxelize(request, mesh, {});
    if (summary.ok()) {
      voxels += summary->voxels;
    } else {
      failed = true;
      std::fprintf(stderr, "part %u: %s\n", index, summary.status().ToString().c_str());
    }
  };
  std::vector<std::thread> threads;
  for (uint32_t index = 0; index < parts; ++index) threads.emplace_back(run, index);
  for (std::thread& thread : threads) thread.join();
  if (failed) return 1;
  std::printf("%llu voxels in %u parts\n", static_cast<unsigned long long>(voxels.load()), parts);
}
