// Checks a server's answers against the protocol. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_ANSWER_CHECK_H_
#define LATVOX_CLIENT_INTERNAL_ANSWER_CHECK_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/status/statusor.h"
#include "client/internal/digest.h"
#include "latvox/types.h"
#include "latvox/v1/voxelizer.pb.h"
#include "latvox/voxelize_handlers.h"

namespace latvox::client {

// The answers of one Voxelize call, checked in order. They come from one stream, or from several; each later stream was
// asked to continue after resume_after(). Memory: one batch, which may be a tile that came in parts, and 12 bytes for
// each tile seen.
class AnswerCheck {
 public:
  // `mesh_bytes` is the length of the mesh; 0: not known. `request` must outlive this.
  AnswerCheck(const VoxelizeHandlers& handlers, uint64_t mesh_bytes, const VoxelizeRequest& request)
      : handlers_(handlers), mesh_bytes_(mesh_bytes), request_(request) {}

  // Begins a new stream. Not necessary before the first one.
  void BeginStretch();

  // Checks the next answer and passes it on. Errors: DATA_LOSS naming its fault; errors of the handler.
  absl::Status Receive(const v1::VoxelizeResponse& answer);

  // Whether Accepted has been passed on, and the tile of the last brick passed on: batches hold whole tiles.
  bool accepted() const { return accepted_.has_value(); }
  const Accepted& accepted_facts() const { return *accepted_; }  // precondition: accepted()
  const std::optional<Vec3i>& resume_after() const { return resume_after_; }

  // Returns the last stream's summary, with counts and digest of all streams together. Errors: DATA_LOSS if there was
  // no Summary.
  absl::StatusOr<Summary> End() const;

 private:
  absl::Status ReceiveAccepted(const v1::Accepted& message);
  absl::Status CompareAccepted(const Accepted& again) const;
  absl::Status ReceiveBricks(const v1::BrickBatch& message);
  absl::Status DecodeMasks(const v1::BrickBatch& message);
  absl::Status DecodePacked(const v1::BrickBatch& message);
  absl::Status ReceiveFields(const v1::BrickBatch& message, size_t voxels);
  absl::Status ReceiveField(const v1::FieldValues& message, size_t voxels, FieldValues& out);
  absl::Status PassOn();
  absl::Status ReceiveSummary(const v1::Summary& message);
  absl::Status CheckSet(const Certificate& certificate) const;
  absl::Status CheckNeighbors() const;
  absl::Status CheckFractionLabels() const;
  absl::Status CheckFields(const Certificate& certificate) const;
  absl::Status CheckBrick(const Brick& brick, const Brick* previous);

  const VoxelizeHandlers& handlers_;
  const uint64_t mesh_bytes_;
  const VoxelizeRequest& request_;
  std::optional<Accepted> accepted_;
  std::optional<Summary> summary_;
  std::optional<Vec3i> resume_after_;
  std::vector<Brick> batch_, part_;   // whole tiles, and the last message's bricks
  std::vector<FieldValues> fields_;   // of batch_
  bool tile_continues_ = false;       // batch_ lacks the rest of its tile
  std::string packed_;                // of the last batch that was a zstd frame
  absl::flat_hash_set<Vec3i> tiles_;  // all tiles with earlier bricks
  struct Tally {
    uint64_t voxels = 0, bricks = 0, tiles = 0;
    Digest digest;
    std::vector<Digest> fields;  // of voxels and each field
    void Add(const Tally& other);
  };
  Tally before_, stretch_;              // of the streams before this one, and of this one
  bool stretch_accepted_ = false;       // this stream's Accepted has come
  double progress_ = 0, reported_ = 0;  // of this stream, and as passed on
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_ANSWER_CHECK_H_
