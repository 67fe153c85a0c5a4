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
// asked to continue after resume_after(). Memory: one batch and 12 bytes for each tile seen.
class AnswerCheck {
 public:
  // `mesh_bytes` is the length of the mesh; 0: not known. `band` and `attributes` are those of the request.
  AnswerCheck(const VoxelizeHandlers& handlers, uint64_t mesh_bytes, const std::optional<Band>& band = std::nullopt,
              const std::vector<Attribute>& attributes = {})
      : handlers_(handlers), mesh_bytes_(mesh_bytes), band_(band), asked_(attributes) {}

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
  absl::Status ReceiveValues(std::string_view bytes, size_t voxels);
  absl::Status ReceiveAttributes(std::string_view bytes, size_t voxels);
  absl::Status CheckValue(float value) const;
  absl::Status ReceiveSummary(const v1::Summary& message);
  absl::Status CheckBand(const std::optional<BandCertificate>& band) const;
  absl::Status CheckAttributes(const std::optional<AttributeCertificate>& certificate) const;
  double BandWidth() const;
  absl::Status CheckBrick(const Brick& brick, const Brick* previous);

  const VoxelizeHandlers& handlers_;
  const uint64_t mesh_bytes_;
  const std::optional<Band> band_;
  const std::vector<Attribute> asked_;
  std::optional<Accepted> accepted_;
  std::optional<Summary> summary_;
  std::optional<Vec3i> resume_after_;
  std::vector<Brick> batch_;
  std::vector<float> values_;         // of batch_
  std::vector<uint32_t> attributes_;  // of batch_
  std::string packed_;                // of the last batch that was a zstd frame
  absl::flat_hash_set<Vec3i> tiles_;  // all tiles with earlier bricks
  struct Tally {
    uint64_t voxels = 0, bricks = 0, tiles = 0;
    Digest digest, values, attributes;
    void Add(const Tally& other);
  };
  Tally before_, stretch_;              // of the streams before this one, and of this one
  bool stretch_accepted_ = false;       // this stream's Accepted has come
  double progress_ = 0, reported_ = 0;  // of this stream, and as passed on
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_ANSWER_CHECK_H_
