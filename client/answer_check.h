// Holds a server's answers against the protocol. Internal to the SDK.
#ifndef LATVOX_CLIENT_ANSWER_CHECK_H_
#define LATVOX_CLIENT_ANSWER_CHECK_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "client/client.h"
#include "client/digest.h"
#include "client/types.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox::client {

// The answers of one Voxelize call, taken in order. Memory: one batch and 12 bytes for each tile seen.
class AnswerCheck {
 public:
  // `mesh_bytes` is what the client sends.
  AnswerCheck(const VoxelizeHandlers& handlers, uint64_t mesh_bytes) : handlers_(handlers), mesh_bytes_(mesh_bytes) {}

  // Checks the next answer and hands it on. Errors: DATA_LOSS naming what is wrong with it; what the handler returned.
  absl::Status Take(const v1::VoxelizeResponse& answer);

  // What the stream ended with. Errors: DATA_LOSS if there was no Summary.
  absl::StatusOr<Summary> End() const;

 private:
  absl::Status TakeAccepted(const v1::Accepted& message);
  absl::Status TakeBricks(const v1::BrickBatch& message);
  absl::Status TakeMasks(const v1::BrickBatch& message);
  absl::Status TakePacked(const v1::BrickBatch& message);
  absl::Status TakeSummary(const v1::Summary& message);
  absl::Status CheckBrick(const Brick& brick, const Brick* previous);

  const VoxelizeHandlers& handlers_;
  const uint64_t mesh_bytes_;
  std::optional<Accepted> accepted_;
  std::optional<Summary> summary_;
  std::vector<Brick> batch_;
  std::string packed_;                // of the last batch that was a zstd frame
  absl::flat_hash_set<Vec3i> tiles_;  // all that earlier bricks lie in
  uint64_t voxels_ = 0, bricks_ = 0;
  Digest digest_;
  double progress_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_ANSWER_CHECK_H_
