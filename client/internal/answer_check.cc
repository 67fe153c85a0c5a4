#include "client/internal/answer_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/brick_codec.h"
#include "client/internal/printable.h"
#include "client/internal/wire.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

constexpr size_t kMaskBytes = sizeof(Brick::mask);
constexpr int kBrickBits = 3;         // log2 of a brick's side in voxels
constexpr int kTileBitsInBricks = 3;  // log2 of a tile's side in bricks

template <class... Parts>
absl::Status Broken(const Parts&... parts) {
  return absl::DataLossError(Printable(absl::StrCat("the server broke the protocol: ", parts...)));
}

bool IsFinite(const Vec3d& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

bool IsUsable(const GridTransform& grid) {
  const auto& [a, b, c] = grid.basis;
  const double det =
      a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  return IsFinite(a) && IsFinite(b) && IsFinite(c) && IsFinite(grid.origin) && std::isfinite(det) && det != 0 &&
         std::isfinite(grid.voxel_size) && grid.voxel_size > 0;
}

Vec3i TileOf(const Vec3i& brick_ijk) {
  return {brick_ijk[0] >> kTileBitsInBricks, brick_ijk[1] >> kTileBitsInBricks, brick_ijk[2] >> kTileBitsInBricks};
}

// Adds each brick with its part of the values, `each` for every voxel.
template <class T>
void AddValues(const std::vector<Brick>& bricks, std::span<const T> values, size_t each, Digest& digest) {
  for (const Brick& brick : bricks) {
    const size_t count = CountVoxels(brick) * each;
    digest.Add(brick, values.first(count));
    values = values.subspan(count);
  }
}

}  // namespace

void AnswerCheck::Tally::Add(const Tally& other) {
  voxels += other.voxels;
  bricks += other.bricks;
  tiles += other.tiles;
  digest.Add(other.digest);
  values.Add(other.values);
  attributes.Add(other.attributes);
}

void AnswerCheck::BeginStretch() {
  before_.Add(stretch_);
  stretch_ = {};
  stretch_accepted_ = false;
  summary_.reset();
  progress_ = 0;
}

absl::Status AnswerCheck::Receive(const v1::VoxelizeResponse& answer) {
  if (summary_) return Broken("an answer after the summary");
  if (!stretch_accepted_ && !answer.has_accepted()) return Broken("the first answer is not Accepted");
  switch (answer.part_case()) {
    case v1::VoxelizeResponse::kAccepted:
      return ReceiveAccepted(answer.accepted());
    case v1::VoxelizeResponse::kBricks:
      return ReceiveBricks(answer.bricks());
    case v1::VoxelizeResponse::kSummary:
      return ReceiveSummary(answer.summary());
    case v1::VoxelizeResponse::PART_NOT_SET:
      break;
  }
  return Broken("an empty answer");
}

absl::Status AnswerCheck::ReceiveAccepted(const v1::Accepted& message) {
  if (stretch_accepted_) return Broken("Accepted came twice");
  stretch_accepted_ = true;
  if (accepted_) return CompareAccepted(FromProto(message));
  accepted_ = FromProto(message);
  if (!IsUsable(accepted_->grid)) return Broken("the grid is not finite or is singular");
  if (const auto& box = accepted_->index_box) {
    for (size_t m = 0; m < 3; ++m) {
      if (box->min[m] >= box->max[m]) return Broken("index_box is empty on axis ", m);
    }
  }
  return handlers_.on_accepted ? handlers_.on_accepted(*accepted_) : absl::OkStatus();
}

// The request id identifies the stream, and the number of tiles that are left is not a fact of the whole.
absl::Status AnswerCheck::CompareAccepted(const Accepted& again) const {
  const char* differs = !(again.grid == accepted_->grid)          ? "grid"
                        : again.index_box != accepted_->index_box ? "index_box"
                        : !(again.mesh == accepted_->mesh)        ? "mesh"
                                                                  : nullptr;
  if (differs == nullptr) return absl::OkStatus();
  return Broken("the stream was resumed, and Accepted.", differs, " is not what it was before");
}

absl::Status AnswerCheck::ReceiveBricks(const v1::BrickBatch& message) {
  // Negated comparisons, to find NaN.
  if (!(message.progress() >= progress_ && message.progress() <= 1)) {
    return Broken("progress ", message.progress(), " after ", progress_);
  }
  progress_ = message.progress();
  reported_ = std::max(reported_, progress_);
  const bool packed = !message.packed().empty() || message.packed_bytes() != 0;
  if (absl::Status status = packed ? DecodePacked(message) : DecodeMasks(message); !status.ok()) return status;
  const uint64_t voxels_before = stretch_.voxels;
  for (size_t n = 0; n < batch_.size(); ++n) {
    if (auto status = CheckBrick(batch_[n], n == 0 ? nullptr : &batch_[n - 1]); !status.ok()) return status;
  }
  const uint64_t voxels = stretch_.voxels - voxels_before;
  if (absl::Status status = ReceiveValues(message.values(), voxels); !status.ok()) return status;
  if (absl::Status status = ReceiveAttributes(message.attributes(), voxels); !status.ok()) return status;
  if (handlers_.on_bricks) {
    if (auto status = handlers_.on_bricks({batch_, reported_, values_, attributes_}); !status.ok()) return status;
  }
  if (!batch_.empty()) resume_after_ = TileOf(batch_.back().brick_ijk);
  return absl::OkStatus();
}

absl::Status AnswerCheck::DecodePacked(const v1::BrickBatch& message) {
  if (message.brick_ijk_size() != 0 || !message.masks().empty()) return Broken("a batch of both masks and packed");
  absl::Status status;
  if (message.packed_bytes() != 0) {
    status = Decompress(message.packed(), message.packed_bytes(), packed_);
    if (status.ok()) status = UnpackBricks(packed_, batch_);
  } else {
    status = UnpackBricks(message.packed(), batch_);
  }
  return status.ok() ? status : Broken(status.message());
}

absl::Status AnswerCheck::DecodeMasks(const v1::BrickBatch& message) {
  const size_t coordinates = static_cast<size_t>(message.brick_ijk_size());
  const size_t count = coordinates / 3;
  if (coordinates % 3 != 0) return Broken("brick_ijk has ", coordinates, " numbers, not a multiple of 3");
  if (message.masks().size() != count * kMaskBytes) {
    return Broken("masks has ", message.masks().size(), " bytes for ", count, " bricks of ", kMaskBytes);
  }
  batch_.resize(count);
  for (size_t n = 0; n < count; ++n) {
    Brick& brick = batch_[n];
    for (size_t m = 0; m < 3; ++m) brick.brick_ijk[m] = message.brick_ijk(static_cast<int>(3 * n + m));
    std::memcpy(brick.mask.data(), message.masks().data() + n * kMaskBytes, kMaskBytes);
  }
  return absl::OkStatus();
}

// A set of tiles, rather than their Morton order, finds repeated tiles. The order begins at the whole mesh's index box,
// which a request with a region does not learn. Within a tile the order is strict, so no brick can come twice.
absl::Status AnswerCheck::CheckBrick(const Brick& brick, const Brick* previous) {
  const auto where = [&brick] { return absl::StrJoin(brick.brick_ijk, ","); };
  if (!accepted_->index_box) return Broken("brick ", where(), " although there is no index_box");
  for (size_t m = 0; m < 3; ++m) {
    const IndexBox& box = *accepted_->index_box;
    if (brick.brick_ijk[m] < box.min[m] >> kBrickBits || brick.brick_ijk[m] > (box.max[m] - 1) >> kBrickBits) {
      return Broken("brick ", where(), " lies outside of index_box");
    }
  }
  const uint64_t voxels = CountVoxels(brick);
  if (voxels == 0) return Broken("brick ", where(), " is empty");
  const Vec3i tile = TileOf(brick.brick_ijk);
  if (previous != nullptr && TileOf(previous->brick_ijk) == tile) {
    if (!(previous->brick_ijk < brick.brick_ijk)) return Broken("brick ", where(), " is out of order");
  } else if (!tiles_.insert(tile).second) {
    return Broken("tile ", absl::StrJoin(tile, ","), " came twice");
  } else {
    ++stretch_.tiles;
  }
  stretch_.voxels += voxels;
  ++stretch_.bricks;
  stretch_.digest.Add(brick);
  return absl::OkStatus();
}

// `bytes` are the values of batch_, which has been checked, and has `voxels` voxels.
absl::Status AnswerCheck::ReceiveValues(std::string_view bytes, size_t voxels) {
  const size_t expected = band_ ? voxels * sizeof(float) : 0;
  if (bytes.size() != expected) {
    return Broken("values has ", bytes.size(), " bytes for ", voxels, " voxels", band_ ? "" : " without a band",
                  ", not ", expected);
  }
  if (!band_) return absl::OkStatus();
  values_.resize(voxels);
  if (voxels != 0) std::memcpy(values_.data(), bytes.data(), bytes.size());
  for (const float value : values_) {
    if (absl::Status status = CheckValue(value); !status.ok()) return status;
  }
  AddValues<float>(batch_, values_, 1, stretch_.values);
  return absl::OkStatus();
}

absl::Status AnswerCheck::ReceiveAttributes(std::string_view bytes, size_t voxels) {
  const size_t numbers = voxels * asked_.size();
  if (bytes.size() != numbers * sizeof(uint32_t)) {
    return Broken("attributes has ", bytes.size(), " bytes for ", asked_.size(), " each of ", voxels, " voxels, not ",
                  numbers * sizeof(uint32_t));
  }
  attributes_.resize(numbers);
  if (numbers == 0) return absl::OkStatus();
  std::memcpy(attributes_.data(), bytes.data(), bytes.size());
  for (size_t n = 0; n < numbers; ++n) {
    const uint32_t largest = asked_[n % asked_.size()] == Attribute::kColor ? 0xFFFFFF : 0x7FFFFFFF;
    if (attributes_[n] > largest) return Broken("an attribute of ", attributes_[n], ", more than ", largest);
  }
  AddValues<uint32_t>(batch_, attributes_, asked_.size(), stretch_.attributes);
  return absl::OkStatus();
}

// Negated comparisons, to find NaN.
absl::Status AnswerCheck::CheckValue(float value) const {
  const double width = std::min(BandWidth(), double{std::numeric_limits<float>::max()});
  if (!(std::abs(value) <= static_cast<float>(width))) {
    return Broken("a distance of ", value, " in a band of ", width);
  }
  if (std::signbit(value) && !(band_->is_signed && value < 0)) {
    return Broken("a distance of ", value, " in ", band_->is_signed ? "a signed band" : "a band without signs");
  }
  return absl::OkStatus();
}

double AnswerCheck::BandWidth() const {
  return band_->in_voxels ? band_->width * accepted_->grid.voxel_size : band_->width;
}

// Checks the certificate's facts about the band.
absl::Status AnswerCheck::CheckBand(const std::optional<BandCertificate>& band) const {
  if (!band_ && !band) return absl::OkStatus();
  if (!band_ || !band) return Broken("a certificate ", band ? "of a band" : "without a band");
  if (band->width != BandWidth() || band->is_signed != band_->is_signed) {
    return Broken("a band of ", band->width, ", ", band->is_signed ? "" : "not ", "signed, instead of ", BandWidth());
  }
  if (band->digest == stretch_.values.ToHex()) return absl::OkStatus();
  return Broken("band's digest ", band->digest, ", the values' is ", stretch_.values.ToHex());
}

absl::Status AnswerCheck::CheckAttributes(const std::optional<AttributeCertificate>& certificate) const {
  if (asked_ != (certificate ? certificate->attributes : std::vector<Attribute>())) {
    return Broken("a certificate of other attributes than were asked for");
  }
  if (!certificate || certificate->digest == stretch_.attributes.ToHex()) return absl::OkStatus();
  return Broken("attributes' digest ", certificate->digest, ", theirs is ", stretch_.attributes.ToHex());
}

absl::Status AnswerCheck::ReceiveSummary(const v1::Summary& message) {
  Summary summary = FromProto(message);
  const auto check = [](const char* what, uint64_t theirs, uint64_t ours) {
    return theirs == ours ? absl::OkStatus() : Broken("summary of ", theirs, " ", what, " after ", ours);
  };
  absl::Status status = check("voxels", summary.voxels, stretch_.voxels);
  status.Update(check("bricks", summary.bricks, stretch_.bricks));
  status.Update(check("tiles", summary.tiles, stretch_.tiles));
  if (mesh_bytes_ != 0) status.Update(check("mesh bytes", summary.mesh_bytes, mesh_bytes_));
  if (!status.ok()) return status;
  if (summary.certificate.digest != stretch_.digest.ToHex()) {
    return Broken("digest ", summary.certificate.digest, ", the bricks' is ", stretch_.digest.ToHex());
  }
  status = CheckBand(summary.certificate.band);
  status.Update(CheckAttributes(summary.certificate.attributes));
  if (!status.ok()) return status;
  Tally all = before_;
  all.Add(stretch_);
  summary.voxels = all.voxels;
  summary.bricks = all.bricks;
  summary.tiles = all.tiles;
  summary.certificate.digest = all.digest.ToHex();
  if (band_) summary.certificate.band->digest = all.values.ToHex();
  if (summary.certificate.attributes) summary.certificate.attributes->digest = all.attributes.ToHex();
  summary_ = summary;
  return absl::OkStatus();
}

absl::StatusOr<Summary> AnswerCheck::End() const {
  if (!summary_) return Broken("the stream ended without a summary");
  return *summary_;
}

}  // namespace latvox::client
