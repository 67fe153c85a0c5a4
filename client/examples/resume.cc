// A stream that outlives its server. It prints all bricks, and on standard error the places and reasons of each new
// stream. Try it with a server that you kill and start again, or with two servers.
#include <latvox/client.h>

#include "example.h"

int main(int argc, char** argv) {
  namespace lv = latvox::client;
  if (argc != 4) return example::Usage("resume ADDRESS[,ADDRESS...] MESH.drc RESOLUTION");
  const auto mesh = example::Read(argv[2]);
  if (!mesh.ok()) return example::Fail(mesh.status());
  const auto client = lv::Client::Connect(argv[1]);
  if (!client.ok()) return example::Fail(client.status());

  lv::VoxelizeHandlers handlers;
  handlers.on_bricks = [](const lv::BrickBatch& batch) {
    for (const lv::Brick& brick : batch.bricks) {
      const auto& [i, j, k] = brick.brick_ijk;
      std::printf("%d,%d,%d\n", i, j, k);
    }
    return absl::OkStatus();
  };
  handlers.on_resumed = [](const lv::Resumption& resumption) {
    std::fprintf(stderr, "goes on at %s after: ", resumption.address.c_str());
    return example::Fail(resumption.cause), absl::OkStatus();
  };
  lv::VoxelizeRequest request;
  request.resolution = example::Number(argv[3]);
  lv::CallOptions options;
  options.retry.max_retries = 100;  // without progress: some minutes for a server to come back
  const auto summary = client->Voxelize(request, *mesh, handlers, options);
  if (!summary.ok()) return example::Fail(summary.status());
  std::fprintf(stderr, "%llu bricks, resumed %d times, digest %s\n", static_cast<unsigned long long>(summary->bricks),
               summary->resumed, summary->certificate.digest.c_str());
}
