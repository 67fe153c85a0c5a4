#include "client/grid/part_metadata.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/algorithm/container.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/grid/warning_metadata.h"
#include "client/internal/digest.h"
#include "client/internal/printable.h"

namespace latvox::client {
namespace {

constexpr char kShard[] = "latvox_shard", kVerified[] = "latvox_verified";
constexpr char kMinimal[] = "latvox_minimal", kWholeMinimal[] = "latvox_whole_minimal";
constexpr char kRequest[] = "latvox_request";
constexpr const char* kCutOut[] = {"latvox_region", "latvox_bounds"};
constexpr const char* kTrueIfAll[] = {"latvox_tunnel_free", kMinimal};
constexpr size_t kMissingNamed = 8;

using Parts = std::vector<std::unique_ptr<PartFile>>;

bool IsOwn(absl::string_view name) {
  return absl::EndsWith(name, "_digest") || name == kShard || name == kVerified || name == kTrueIfAll[0] ||
         name == kTrueIfAll[1] || name == kRequest || name == kWarningsName || absl::c_linear_search(kCutOut, name) ||
         absl::StartsWith(name, "file_");
}

std::optional<std::string> Find(const PartFile& part, const std::string& name) {
  const openvdb::Metadata::ConstPtr found = part.metadata()[name];
  return found ? std::optional(found->str()) : std::nullopt;
}

std::string Show(const std::optional<std::string>& value) { return Printable(value.value_or("absent")); }

absl::Status Differ(const PartFile& part, absl::string_view field, const std::string& value, const PartFile& first,
                    const std::string& first_value) {
  return absl::InvalidArgumentError(
      absl::StrCat(part.path(), ": ", field, " is ", value, ", but ", first_value, " in ", first.path()));
}

// The steps of i, j and k and the origin, with all digits.
std::string Show(const openvdb::math::Transform& transform) {
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  std::string text;
  for (int row = 0; row < 4; ++row) absl::StrAppendFormat(&text, "%.17g,%.17g,%.17g ", m[row][0], m[row][1], m[row][2]);
  text.pop_back();
  return text;
}

absl::Status CheckSameTransform(const PartFile& part, const PartFile& first) {
  const std::string value = Show(*part.transform()), first_value = Show(*first.transform());
  return value == first_value ? absl::OkStatus() : Differ(part, "the transform", value, first, first_value);
}

// Compares all fields except those of IsOwn, whatever their names. So fields that are added later are compared, too.
absl::Status CheckFields(const PartFile& part, const PartFile& first) {
  std::set<std::string> names;
  for (const PartFile* each : {&first, &part}) {
    for (auto meta = each->metadata().beginMeta(); meta != each->metadata().endMeta(); ++meta)
      names.insert(meta->first);
  }
  for (const std::string& name : names) {
    const auto value = Find(part, name), first_value = Find(first, name);
    if (!IsOwn(name) && value != first_value) return Differ(part, name, Show(value), first, Show(first_value));
  }
  return absl::OkStatus();
}

// Finds the same file twice, or a copy of it: then another one is probably missing. If not, nothing is lost: another
// part with the same voxels can be left out. All empty parts are equal.
absl::Status CheckTwice(const Parts& parts) {
  std::set<std::filesystem::path> places;
  std::map<std::string, const PartFile*> digests;
  const std::string empty = Digest().ToHex();
  for (const auto& part : parts) {
    std::error_code error;
    if (!places.insert(std::filesystem::canonical(part->path(), error)).second) {
      return absl::InvalidArgumentError(absl::StrCat(part->path(), ": is given twice"));
    }
    const auto [other, is_new] = digests.emplace(part->digest(), part.get());
    if (is_new || part->digest() == empty) continue;
    return absl::InvalidArgumentError(absl::StrCat(part->path(), ": holds the same voxels as ", other->second->path(),
                                                   " (latvox_digest ", part->digest(), "), as if given twice"));
  }
  return absl::OkStatus();
}

struct ShardName {
  uint32_t index = 0, count = 0;
};

absl::StatusOr<ShardName> ParseShard(const PartFile& part, const std::string& text) {
  const std::pair<std::string, std::string> words = absl::StrSplit(text, absl::MaxSplits('/', 1));
  ShardName shard;
  if (absl::SimpleAtoi(words.first, &shard.index) && absl::SimpleAtoi(words.second, &shard.count) &&
      shard.index < shard.count) {
    return shard;
  }
  return absl::InvalidArgumentError(absl::StrCat(part.path(), ": ", kShard, " is ", text, ", not I/N with I below N"));
}

absl::Status MissingShards(const std::map<uint32_t, const PartFile*>& present, uint32_t count) {
  const size_t missing = count - present.size();
  std::vector<uint32_t> named;
  for (uint32_t index = 0; index < count && named.size() < kMissingNamed; ++index) {
    if (!present.contains(index)) named.push_back(index);
  }
  return absl::InvalidArgumentError(absl::StrCat("latvox_shard: ", present.size(), " of ", count,
                                                 " shards are there; missing ", absl::StrJoin(named, ", "),
                                                 missing > named.size() ? ", ..." : ""));
}

// Returns whether the parts are shards.
absl::StatusOr<bool> CheckShards(const Parts& parts) {
  std::map<uint32_t, const PartFile*> present;
  std::optional<uint32_t> count;
  const PartFile& first = *parts.front();
  const auto first_value = Find(first, kShard);
  for (const auto& part : parts) {
    const auto value = Find(*part, kShard);
    if (value.has_value() != first_value.has_value()) {
      return Differ(*part, kShard, Show(value), first, Show(first_value));
    }
    if (!value) continue;
    const auto shard = ParseShard(*part, *value);
    if (!shard.ok()) return shard.status();
    if (shard->count != count.value_or(shard->count)) return Differ(*part, kShard, *value, first, *first_value);
    count = shard->count;
    const auto [other, is_new] = present.emplace(shard->index, part.get());
    if (is_new) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(part->path(), ": ", kShard, " is ", *value, ", and so it is in ", other->second->path()));
  }
  if (count && present.size() < *count) return MissingShards(present, *count);
  return count.has_value();
}

// Returns the box of all parts together, several boxes with "; " between them; empty if a part has none. All shards of
// a whole have the same box.
absl::StatusOr<std::string> CutOut(const Parts& parts, const char* name, bool shards) {
  const PartFile& first = *parts.front();
  std::vector<std::string> boxes;
  bool cut = true;
  for (const auto& part : parts) {
    const auto value = Find(*part, name), first_value = Find(first, name);
    if (shards && value != first_value) return Differ(*part, name, Show(value), first, Show(first_value));
    cut = cut && value.has_value();
    if (value && !absl::c_linear_search(boxes, *value)) boxes.push_back(*value);
  }
  return cut ? absl::StrJoin(boxes, "; ") : "";
}

std::string WarningsOf(const Parts& parts) {
  std::vector<std::string> texts;
  for (const auto& part : parts) {
    if (auto text = Find(*part, kWarningsName)) texts.push_back(*std::move(text));
  }
  return JoinedWarnings(texts);
}

bool IsTrue(const PartFile& part, const char* name) {
  const auto found = part.metadata().getMetadata<openvdb::BoolMetadata>(name);
  return found && found->value();
}

}  // namespace

absl::Status SharedBrick(const std::string& path, const std::string& other, const Vec3i& brick_ijk) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": holds brick ", absl::StrJoin(brick_ijk, ","),
                                                 ", and so does ", other, ": these are no shards of one whole"));
}

absl::StatusOr<CommonFacts> JoinMetadata(const Parts& parts) {
  const PartFile& first = *parts.front();
  for (const auto& part : parts) {
    if (auto status = CheckSameTransform(*part, first); !status.ok()) return status;
    if (auto status = CheckFields(*part, first); !status.ok()) return status;
  }
  const auto shards = CheckShards(parts);
  if (!shards.ok()) return shards.status();
  if (auto status = CheckTwice(parts); !status.ok()) return status;
  CommonFacts common{{}, *shards};
  for (auto meta = first.metadata().beginMeta(); meta != first.metadata().endMeta(); ++meta) {
    if (!IsOwn(meta->first)) common.metadata.insertMeta(meta->first, *meta->second);
  }
  for (const char* name : kCutOut) {
    const auto cut = CutOut(parts, name, *shards);
    if (!cut.ok()) return cut.status();
    if (!cut->empty()) common.metadata.insertMeta(name, openvdb::StringMetadata(*cut));
  }
  const auto request = Find(first, kRequest);
  const auto has_it = [&](const auto& part) { return Find(*part, kRequest) == request; };
  if (request && absl::c_all_of(parts, has_it)) common.metadata.insertMeta(kRequest, openvdb::StringMetadata(*request));
  if (const std::string warnings = WarningsOf(parts); !warnings.empty()) {
    common.metadata.insertMeta(kWarningsName, openvdb::StringMetadata(warnings));
  }
  for (const char* name : kTrueIfAll) {
    const auto is_true = [name](const auto& part) { return IsTrue(*part, name); };
    common.metadata.insertMeta(name, openvdb::BoolMetadata(std::all_of(parts.begin(), parts.end(), is_true)));
  }
  if (common.shards && IsTrue(first, kWholeMinimal)) common.metadata.insertMeta(kMinimal, openvdb::BoolMetadata(true));
  common.metadata.insertMeta(kVerified, openvdb::BoolMetadata(parts.size() == 1 && IsTrue(first, kVerified)));
  return common;
}

}  // namespace latvox::client
