#include "client/tool/texture/color_stream.h"

#include <cstring>
#include <span>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/mesh/srgb.h"

namespace latvox::client {
namespace {

std::vector<Field> WithPlace(std::vector<Field> fields) {
  for (const Field field : {Field::kTriangle, Field::kPoint}) {
    if (!CarriesField(fields, field)) fields.push_back(field);
  }
  return fields;
}

Vec3i TileOf(const Brick& brick) {
  const auto& [i, j, k] = brick.brick_ijk;
  return {i >> 3, j >> 3, k >> 3};
}

}  // namespace

ColorStream::ColorStream(BaseColorSampler sampler, const VoxelizeRequest& request, std::optional<double> alpha_cutoff)
    : sampler_(std::move(sampler)),
      request_(request),
      alpha_cutoff_(alpha_cutoff),
      sent_(WithPlace(request.fields)),
      field_digests_(request.fields.size()) {}

VoxelizeRequest ColorStream::ToSend() const {
  VoxelizeRequest request = request_;
  request.fields = sent_;
  return request;
}

bool ColorStream::Receive(const Voxel& voxel, Color& color) {
  const uint32_t triangle = voxel.Of<uint32_t>(Field::kTriangle)[0];
  const auto point = voxel.Of<float>(Field::kPoint);
  const auto sample = sampler_.At(triangle, {point[0], point[1]}, edge_);
  if (alpha_cutoff_ && static_cast<double>(sample.color[3]) < *alpha_cutoff_) return false;
  if (sample.has_image) {
    color = ToSrgb({sample.color[0], sample.color[1], sample.color[2]});
  } else if (const auto own = voxel.Of<uint8_t>(Field::kColor); !own.empty()) {
    color = {own[0], own[1], own[2]};
  }
  return true;
}

void ColorStream::Keep(const Voxel& voxel, const Color& color) {
  for (FieldValues& values : fields_) {
    const size_t bytes = values.bytes_of_voxel(), end = values.bytes.size();
    values.bytes.resize(end + bytes);
    const void* const from = values.field == Field::kColor
                                 ? static_cast<const void*>(color.data())
                                 : FindField(voxel.fields, values.field)->bytes.data() + voxel.number * bytes;
    std::memcpy(&values.bytes[end], from, bytes);
  }
}

// Adds the last brick, whose values are at the end of each field.
void ColorStream::Count(const Brick& brick) {
  const size_t voxels = CountVoxels(brick);
  digest_.Add(brick);
  for (size_t n = 0; n < fields_.size(); ++n) {
    const std::span<const std::byte> all = fields_[n].bytes;
    field_digests_[n].Add(brick, all.last(voxels * fields_[n].bytes_of_voxel()));
  }
  voxels_ += voxels;
  ++brick_count_;
  if (last_tile_ != TileOf(brick)) ++tiles_;  // those of a tile follow each other
  last_tile_ = TileOf(brick);
}

BrickBatch ColorStream::Convert(const BrickBatch& batch) {
  bricks_.clear();
  for (FieldValues& values : fields_) values.bytes.clear();
  size_t number = 0;
  for (const Brick& brick : batch.bricks) {
    Brick kept{brick.brick_ijk, {}};
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const Voxel voxel{ijk, number++, batch.fields};
      Color color{};
      if (!Receive(voxel, color)) {
        ++dropped_;
        return;
      }
      kept.mask[static_cast<size_t>(ijk[0] & 7)] |= uint64_t{1} << ((ijk[1] & 7) << 3 | (ijk[2] & 7));
      Keep(voxel, color);
    });
    if (CountVoxels(kept) == 0) continue;
    bricks_.push_back(kept);
    Count(kept);
  }
  return {bricks_, batch.progress, fields_};
}

void ColorStream::Finish(Summary& summary) const {
  Certificate& certificate = summary.certificate;
  certificate.fields.clear();
  for (size_t n = 0; n < request_.fields.size(); ++n) {
    certificate.fields.push_back({request_.fields[n], field_digests_[n].ToHex()});
  }
  if (!alpha_cutoff_) return;
  certificate.tunnel_free = certificate.minimal = certificate.whole_minimal = false;
  if (dropped_ == 0) return;
  summary.voxels = voxels_;
  summary.bricks = brick_count_;
  summary.tiles = tiles_;
  certificate.digest = digest_.ToHex();
  if (voxels_ > 0) return;
  summary.warnings.push_back(
      {"EMPTY_RESULT",
       absl::StrCat("all ", dropped_, " voxels have an opacity below the alpha cutoff ", *alpha_cutoff_),
       "alpha_cutoff"});
}

}  // namespace latvox::client
