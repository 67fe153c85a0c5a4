// Tests a program that uses latvox without a server: its Client talks to an object of the test's own.
#include <latvox/client.h>

#include <cstdio>
#include <memory>

namespace lv = latvox::client;

// The program: returns the number of bricks of a mesh, or a message for its user.
std::string CountBricks(const lv::Client& client, const std::string& mesh) {
  size_t bricks = 0;
  lv::VoxelizeRequest request;
  request.resolution = 64;
  const auto count = [&](const lv::BrickBatch& batch) { return bricks += batch.bricks.size(), absl::OkStatus(); };
  const auto summary = client.Voxelize(request, mesh, {.on_bricks = count});
  if (summary.ok()) return std::to_string(bricks);
  if (absl::IsUnavailable(summary.status())) return "try again later";
  return std::string(summary.status().message());
}

// The test's server: two bricks, then the end that the test needs.
class FakeServer final : public lv::VoxelService {
 public:
  explicit FakeServer(absl::Status end) : end_(std::move(end)) {}

  absl::StatusOr<lv::Summary> Voxelize(const lv::VoxelizeRequest& request, const lv::MeshInput& mesh,
                                       const lv::VoxelizeHandlers& handlers, const lv::CallOptions&) override {
    if (mesh.drc->empty() || request.resolution != 64u) return absl::InvalidArgumentError("not what the test expects");
    const lv::Brick bricks[] = {{{0, 0, 0}, {1}}, {{0, 0, 1}, {1}}};
    if (absl::Status status = handlers.on_bricks({bricks, 1}); !status.ok()) return status;
    if (!end_.ok()) return end_;
    lv::Summary summary;
    summary.bricks = summary.voxels = 2;
    return summary;
  }

 private:
  const absl::Status end_;
};

int main() {
  const auto program_says = [](const absl::Status& end) {
    return CountBricks(lv::Client(std::make_shared<FakeServer>(end)), "a mesh");
  };
  const bool right = program_says(absl::OkStatus()) == "2" &&
                     program_says(absl::UnavailableError("no server")) == "try again later" &&
                     program_says(absl::ResourceExhaustedError("max_triangles")) == "max_triangles";
  std::puts(right ? "passed" : "failed");
  return right ? 0 : 1;
}
