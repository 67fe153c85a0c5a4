#include "client/internal/answer_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "absl/strings/str_join.h"
#include "client/internal/brick_codec.h"
#include "client/internal/broken_protocol.h"
#include "client/internal/field_check.h"
#include "client/internal/wire.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

constexpr size_t kMaskBytes = sizeof(Brick::mask);
constexpr int kBrickBits = 3;         // log2 of a brick's side in voxels
constexpr int kTileBitsInBricks = 3;  // log2 of a tile's side in bricks
constexpr size_t kTileBricks = 512;

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

// wire.h would read an unknown kind as none: as proof that the point is enclosed.
absl::Status CheckLeaks(const v1::WalkFacts& walk) {
  const auto is_known = [](const auto& facts) {
    const v1::LeakKind kind = facts.leak().kind();
    return !facts.has_leak() || (v1::LeakKind_IsValid(kind) && kind != v1::LEAK_KIND_UNSPECIFIED);
  };
  return is_known(walk) && std::ranges::all_of(walk.labels(), is_known) ? absl::OkStatus()
                                                                        : Broken("a leak of an unknown kind");
}

Vec3i TileOf(const Vec3i& brick_ijk) {
  return {brick_ijk[0] >> kTileBitsInBricks, brick_ijk[1] >> kTileBitsInBricks, brick_ijk[2] >> kTileBitsInBricks};
}

// Adds each brick with its part of a field.
void AddField(const std::vector<Brick>& bricks, const FieldValues& field, Digest& digest) {
  std::span<const std::byte> values = field.bytes;
  for (const Brick& brick : bricks) {
    const size_t bytes = CountVoxels(brick) * field.bytes_of_voxel();
    digest.Add(brick, values.first(bytes));
    values = values.subspan(bytes);
  }
}

// Appends values whose n-th bytes stand together, for each n in turn.
void AppendPlanes(std::string_view planes, size_t bytes_of_voxel, std::vector<std::byte>& out) {
  const size_t voxels = planes.size() / bytes_of_voxel, before = out.size();
  out.resize(before + planes.size());
  for (size_t n = 0; n < bytes_of_voxel; ++n) {
    for (size_t voxel = 0; voxel < voxels; ++voxel) {
      out[before + voxel * bytes_of_voxel + n] = static_cast<std::byte>(planes[n * voxels + voxel]);
    }
  }
}

}  // namespace

void AnswerCheck::Tally::Add(const Tally& other) {
  voxels += other.voxels;
  bricks += other.bricks;
  tiles += other.tiles;
  digest.Add(other.digest);
  fields.resize(std::max(fields.size(), other.fields.size()));
  for (size_t n = 0; n < other.fields.size(); ++n) fields[n].Add(other.fields[n]);
}

void AnswerCheck::BeginStretch() {
  before_.Add(stretch_);
  stretch_ = {};
  stretch_accepted_ = false;
  summary_.reset();
  progress_ = 0;
  tile_continues_ = false;
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
      if (box->min[m] >= box->max[m]) return Broken("index_box is empty on axis ", std::string(1, "ijk"[m]));
    }
  }
  if (auto status = CheckNeighbors(); !status.ok()) return status;
  if (auto status = CheckFractionLabels(); !status.ok()) return status;
  return handlers_.on_accepted ? handlers_.on_accepted(*accepted_) : absl::OkStatus();
}

// Ascending, so that none comes twice, and each with its opposite.
absl::Status AnswerCheck::CheckNeighbors() const {
  const std::vector<Vec3i>& neighbors = accepted_->neighbors;
  if (neighbors.empty() == CarriesLinks(request_.fields)) return Broken(neighbors.size(), " neighbors");
  if (neighbors.size() > kMostNeighbors) return Broken(neighbors.size(), " neighbors, over ", kMostNeighbors);
  for (size_t n = 0; n < neighbors.size(); ++n) {
    const Vec3i &q = neighbors[n], &opposite = neighbors[neighbors.size() - 1 - n];
    const bool has_opposite =
        int64_t{q[0]} + opposite[0] == 0 && int64_t{q[1]} + opposite[1] == 0 && int64_t{q[2]} + opposite[2] == 0;
    if (has_opposite && (n == 0 || neighbors[n - 1] < q)) continue;
    return Broken("neighbor ", n, " is ", absl::StrJoin(q, ","));
  }
  return absl::OkStatus();
}

// Those of the request, or if it has none, ascending, so that none comes twice.
absl::Status AnswerCheck::CheckFractionLabels() const {
  const std::vector<uint32_t>& labels = accepted_->fraction_labels;
  if (labels.empty() == CarriesField(request_.fields, Field::kLabelFractions)) {
    return Broken(labels.size(), " labels of fractions");
  }
  if (labels.size() > kMostFractionLabels) {
    return Broken(labels.size(), " labels of fractions, over ", kMostFractionLabels);
  }
  const bool is_good = request_.fraction_labels.empty()
                           ? std::ranges::adjacent_find(labels, std::greater_equal()) == labels.end()
                           : labels == request_.fraction_labels;
  return is_good ? absl::OkStatus() : Broken("fractions of the labels ", absl::StrJoin(labels, ","));
}

// The request id identifies the stream, and the number of tiles that are left is not a fact of the whole.
absl::Status AnswerCheck::CompareAccepted(const Accepted& again) const {
  const char* differs = !(again.grid == accepted_->grid)                      ? "grid"
                        : again.index_box != accepted_->index_box             ? "index_box"
                        : !(again.mesh == accepted_->mesh)                    ? "mesh"
                        : again.neighbors != accepted_->neighbors             ? "neighbors"
                        : again.fraction_labels != accepted_->fraction_labels ? "fraction_labels"
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
  if (!tile_continues_) {
    batch_.clear();
    fields_.clear();
    for (const Field field : request_.fields) fields_.push_back(accepted_->NoValues(field));
  }
  batch_.insert(batch_.end(), part_.begin(), part_.end());
  size_t voxels = 0;
  for (const Brick& brick : part_) voxels += CountVoxels(brick);
  if (absl::Status status = ReceiveFields(message, voxels); !status.ok()) return status;
  tile_continues_ = message.tile_continues();
  if (!tile_continues_) return PassOn();
  return batch_.size() <= kTileBricks ? absl::OkStatus() : Broken("a tile of more than ", kTileBricks, " bricks");
}

// Passes on batch_, which is complete, once it has been checked.
absl::Status AnswerCheck::PassOn() {
  for (size_t n = 0; n < batch_.size(); ++n) {
    if (auto status = CheckBrick(batch_[n], n == 0 ? nullptr : &batch_[n - 1]); !status.ok()) return status;
  }
  stretch_.fields.resize(fields_.size());
  for (size_t n = 0; n < fields_.size(); ++n) {
    if (auto status = CheckFieldValues(fields_[n], request_, *accepted_); !status.ok()) return status;
    AddField(batch_, fields_[n], stretch_.fields[n]);
  }
  if (handlers_.on_bricks) {
    if (auto status = handlers_.on_bricks({batch_, reported_, fields_}); !status.ok()) return status;
  }
  if (!batch_.empty()) resume_after_ = TileOf(batch_.back().brick_ijk);
  return absl::OkStatus();
}

absl::Status AnswerCheck::DecodePacked(const v1::BrickBatch& message) {
  if (message.brick_ijk_size() != 0 || !message.masks().empty()) return Broken("a batch of both masks and packed");
  absl::Status status;
  if (message.packed_bytes() != 0) {
    status = Decompress(message.packed(), message.packed_bytes(), kMaxPackedBytes, packed_);
    if (!status.ok()) return Broken("packed: ", status.message());
    status = UnpackBricks(packed_, part_);
  } else {
    status = UnpackBricks(message.packed(), part_);
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
  part_.resize(count);
  for (size_t n = 0; n < count; ++n) {
    Brick& brick = part_[n];
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

// Appends the fields of part_, which has `voxels` voxels.
absl::Status AnswerCheck::ReceiveFields(const v1::BrickBatch& message, size_t voxels) {
  const auto& asked = request_.fields;
  if (static_cast<size_t>(message.fields_size()) != asked.size()) {
    return Broken("a batch with ", message.fields_size(), " fields, not ", asked.size());
  }
  for (size_t n = 0; n < asked.size(); ++n) {
    auto status = ReceiveField(message.fields(static_cast<int>(n)), voxels, fields_[n]);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status AnswerCheck::ReceiveField(const v1::FieldValues& message, size_t voxels, FieldValues& out) {
  const size_t each = out.bytes_of_voxel(), expected = voxels * each;
  const size_t found = message.plain_bytes() != 0 ? message.plain_bytes() : message.values().size();
  if (found != expected) {
    return Broken("the field ", NameOf(out.field), " has ", found, " bytes for ", voxels, " voxels, not ", expected);
  }
  if (message.plain_bytes() != 0) {
    absl::Status status = Decompress(message.values(), message.plain_bytes(), kMaxFieldBytes, packed_);
    if (!status.ok()) return Broken("the field ", NameOf(out.field), ": ", status.message());
    AppendPlanes(packed_, each, out.bytes);
    return absl::OkStatus();
  }
  const auto* const bytes = reinterpret_cast<const std::byte*>(message.values().data());
  out.bytes.insert(out.bytes.end(), bytes, bytes + expected);
  return absl::OkStatus();
}

// Checks the certificate's facts about the set.
absl::Status AnswerCheck::CheckSet(const Certificate& certificate) const {
  if (certificate.set != NameOf(request_.set)) {
    return Broken("the set ", certificate.set, " instead of ", NameOf(request_.set));
  }
  const Band* const band = std::get_if<Band>(&request_.set);
  if (certificate.band.has_value() != (band != nullptr)) {
    return Broken("a certificate ", certificate.band ? "of a band" : "without a band");
  }
  const bool walks = std::holds_alternative<Enclosed>(request_.set) || std::holds_alternative<Connected>(request_.set);
  if (certificate.walk.has_value() != walks) {
    return Broken("a certificate ", walks ? "without" : "with", " facts about a walk");
  }
  const auto* const enclosed = std::get_if<Enclosed>(&request_.set);
  const bool has_labels = enclosed != nullptr && enclosed->labels;
  if (certificate.walk && certificate.walk->labels.empty() == has_labels) {
    return Broken("a certificate ", has_labels ? "without" : "with", " the walks of labels");
  }
  const std::string& rule = certificate.interior_rule;
  if (rule.empty() == NeedsInteriorRule(request_)) {
    return Broken("a certificate ", rule.empty() ? "without" : "with", " a rule for the inside");
  }
  if (request_.interior_rule != InteriorRule::kAuto && rule != NameOf(request_.interior_rule)) {
    return Broken("the rule ", rule, " for the inside instead of ", NameOf(request_.interior_rule));
  }
  if (certificate.band && certificate.band->width != BandWidth(*band, accepted_->grid)) {
    return Broken("a band of ", certificate.band->width, " instead of ", BandWidth(*band, accepted_->grid));
  }
  return absl::OkStatus();
}

// Checks the certificate's digests of fields.
absl::Status AnswerCheck::CheckFields(const Certificate& certificate) const {
  const auto field_of = [](const FieldCertificate& field) { return field.field; };
  if (!std::ranges::equal(certificate.fields, request_.fields, {}, field_of)) {
    return Broken("a certificate of other fields than were asked for");
  }
  if (certificate.signed_distance != request_.signed_distance) {
    return Broken("a certificate of distances ", certificate.signed_distance ? "with" : "without", " signs");
  }
  if (certificate.fraction_n != request_.fraction_n) {
    return Broken("a certificate of fractions by ", certificate.fraction_n, " points instead of ", request_.fraction_n);
  }
  if (certificate.fraction_labels != accepted_->fraction_labels) {
    return Broken("a certificate of fractions of other labels than Accepted has");
  }
  for (size_t n = 0; n < certificate.fields.size(); ++n) {
    const std::string found = (n < stretch_.fields.size() ? stretch_.fields[n] : Digest()).ToHex();
    if (certificate.fields[n].digest == found) continue;
    return Broken("the digest of the field ", NameOf(certificate.fields[n].field), " is ", certificate.fields[n].digest,
                  ", that of its values ", found);
  }
  return absl::OkStatus();
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
  if (tile_continues_) return Broken("a summary before the end of a tile");
  status = CheckSet(summary.certificate);
  status.Update(CheckLeaks(message.certificate().walk()));
  status.Update(CheckFields(summary.certificate));
  if (!status.ok()) return status;
  Tally all = before_;
  all.Add(stretch_);
  summary.voxels = all.voxels;
  summary.bricks = all.bricks;
  summary.tiles = all.tiles;
  summary.certificate.digest = all.digest.ToHex();
  for (size_t n = 0; n < all.fields.size(); ++n) summary.certificate.fields[n].digest = all.fields[n].ToHex();
  summary_ = summary;
  return absl::OkStatus();
}

absl::StatusOr<Summary> AnswerCheck::End() const {
  if (!summary_) return Broken("the stream ended without a summary");
  return *summary_;
}

}  // namespace latvox::client
