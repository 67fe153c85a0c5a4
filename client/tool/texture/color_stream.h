// Colors of textures in the stream of a call.
#ifndef LATVOX_CLIENT_TOOL_TEXTURE_COLOR_STREAM_H_
#define LATVOX_CLIENT_TOOL_TEXTURE_COLOR_STREAM_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/internal/digest.h"
#include "client/mesh/mesh.h"
#include "client/tool/texture/base_color_sampler.h"
#include "latvox/for_each_voxel.h"
#include "latvox/types.h"

namespace latvox::client {

// Stands between a call and its outputs. Batches of `ToSend` become those of the request: Field::kColor is that of
// textures, where the nearest triangle has one, and the voxels that are too transparent are left out. Not thread-safe.
class ColorStream {
 public:
  // `alpha_cutoff`: voxels of less opacity are left out; absent: none.
  ColorStream(BaseColorSampler sampler, const VoxelizeRequest& request, std::optional<double> alpha_cutoff);

  // Returns the request with the fields that this stream needs in addition.
  VoxelizeRequest ToSend() const;

  // Call it first. The voxel size is the edge of the square that a voxel's color is the mean of.
  void Begin(const Accepted& accepted) {
    edge_ = accepted.grid.voxel_size;
    for (const Field field : request_.fields) fields_.push_back(accepted.NoValues(field));
  }

  // Returns the batch for the outputs, which may be empty. It is valid until the next call.
  BrickBatch Convert(const BrickBatch& batch);

  // Call it last. Writes counts and digests of the converted voxels. With an alpha cutoff, nothing is known about
  // tunnels and minimality, whether or not voxels were left out: parts of a whole must say the same. If no voxel is
  // left, the warning is EMPTY_RESULT.
  void Finish(Summary& summary) const;

  uint64_t dropped() const { return dropped_; }

 private:
  // Returns whether the voxel is to be kept, and writes its color, if it has one of its own.
  bool Receive(const Voxel& voxel, Color& color);
  void Keep(const Voxel& voxel, const Color& color);
  void Count(const Brick& brick);

  BaseColorSampler sampler_;
  const VoxelizeRequest request_;
  const std::optional<double> alpha_cutoff_;
  const std::vector<Field> sent_;  // fields
  double edge_ = 0;
  std::vector<Brick> bricks_;        // of the batch
  std::vector<FieldValues> fields_;  // likewise
  Digest digest_;
  std::vector<Digest> field_digests_;
  uint64_t voxels_ = 0, brick_count_ = 0, tiles_ = 0, dropped_ = 0;
  std::optional<Vec3i> last_tile_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_TEXTURE_COLOR_STREAM_H_
