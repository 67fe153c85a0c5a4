// Many meshes in parallel over one Client: each thread takes the next mesh when it is done with one.
#include <latvox/client.h>

#include <atomic>
#include <thread>
#include <vector>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc < 5) return example::Usage("meshes ADDRESS[,ADDRESS...] RESOLUTION THREADS MESH.drc...");
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());
  lv::VoxelizeRequest request;
  request.resolution = example::Number(argv[2]);

  const std::vector<const char*> paths(argv + 4, argv + argc);
  std::vector<absl::StatusOr<lv::Summary>> summaries(paths.size());
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t n; (n = next++) < paths.size();) {
      const auto count = [](const lv::BrickBatch&) { return absl::OkStatus(); };  // a real program keeps the bricks
      const auto mesh = example::Read(paths[n]);
      summaries[n] = mesh.ok() ? client->Voxelize(request, *mesh, {.on_bricks = count}) : mesh.status();
    }
  };
  std::vector<std::thread> threads;
  for (uint32_t n = 0; n < example::Number(argv[3]); ++n) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();

  int status = 0;
  for (size_t n = 0; n < paths.size(); ++n) {
    if (summaries[n].ok()) {
      std::printf("%s: %llu voxels\n", paths[n], static_cast<unsigned long long>(summaries[n]->voxels));
    } else {
      std::fprintf(stderr, "%s: ", paths[n]);
      status = example::Fail(summaries[n].status());
    }
  }
  return status;
}
