#include "server/access/token_set.h"

#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace latvox {
namespace {

constexpr size_t kShortest = 16, kLongest = 512;
constexpr absl::string_view kHashed = "sha256:";

bool IsName(absl::string_view word) {
  return std::all_of(word.begin(), word.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || absl::StrContains("._-", c);
  });
}

// RFC 6750, section 2.1
bool IsToken(absl::string_view word) {
  return std::all_of(word.begin(), word.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || absl::StrContains("-._~+/=", c);
  });
}

std::array<uint8_t, 32> Sha256Of(absl::string_view text) {
  std::array<uint8_t, 32> digest;
  SHA256(reinterpret_cast<const uint8_t*>(text.data()), text.size(), digest.data());
  return digest;
}

// Reads a whole number above 0, with units also bytes such as 64MiB.
std::optional<uint64_t> ReadCount(absl::string_view text, bool with_units) {
  uint64_t unit = 1, count = 0;
  if (with_units) {
    for (const auto& [name, bytes] : {std::pair("KiB", 1ull << 10), {"MiB", 1ull << 20}, {"GiB", 1ull << 30}}) {
      if (absl::ConsumeSuffix(&text, name)) unit = bytes;
    }
  }
  const bool good = absl::SimpleAtoi(text, &count) && count > 0 && count <= std::numeric_limits<uint64_t>::max() / unit;
  return good ? std::optional(count * unit) : std::nullopt;
}

absl::Status AddLimit(absl::string_view word, CallerLimits& limits) {
  const std::vector<absl::string_view> parts = absl::StrSplit(word, absl::MaxSplits('=', 1));
  const absl::string_view name = parts[0];
  if (name != "max-jobs" && name != "max-mesh-bytes" && name != "max-triangles" && name != "max-job-seconds") {
    return absl::InvalidArgumentError(
        "behind the token stands none of max-jobs=N, max-job-seconds=N, max-mesh-bytes=N, max-triangles=N");
  }
  const auto count = ReadCount(parts.size() < 2 ? "" : parts[1], name == "max-mesh-bytes");
  if (!count) return absl::InvalidArgumentError(absl::StrCat(name, " is not a whole number above 0"));
  if (name == "max-mesh-bytes") limits.max_mesh_bytes = *count;
  if (name == "max-triangles") limits.max_triangles = *count;
  if (name == "max-job-seconds") limits.max_job_seconds = *count;
  if (name == "max-jobs") {
    if (*count > std::numeric_limits<uint32_t>::max())
      return absl::InvalidArgumentError("max-jobs is above 4294967295");
    limits.max_jobs = static_cast<uint32_t>(*count);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TokenSet> TokenSet::Parse(absl::string_view text) {
  TokenSet set;
  int number = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    const std::vector<absl::string_view> words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty() || words[0][0] == '#') continue;
    if (absl::Status status = set.AddLine(words); !status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("line ", number, ": ", status.message()));
    }
  }
  if (set.entries_.empty()) return absl::InvalidArgumentError("there is no token");
  return set;
}

absl::Status TokenSet::AddLine(const std::vector<absl::string_view>& words) {
  // Text in the wrong place may be a token, so messages never show it.
  if (words.size() < 2) return absl::InvalidArgumentError("it has no token: NAME TOKEN [LIMIT=N ...]");
  if (!IsName(words[0])) return absl::InvalidArgumentError("the name has other characters than letters, digits, . _ -");
  const auto sha256 = ReadToken(words[1]);
  if (!sha256.ok()) return sha256.status();
  if (IndexOf(*sha256) < entries_.size()) return absl::InvalidArgumentError("the token stands on an earlier line");
  Entry entry{.sha256 = *sha256, .name = std::string{words[0]}, .limits = {}};
  for (size_t n = 2; n < words.size(); ++n) {
    if (absl::Status status = AddLimit(words[n], entry.limits); !status.ok()) return status;
  }
  entries_.push_back(std::move(entry));
  return absl::OkStatus();
}

absl::StatusOr<TokenSet::Sha256> TokenSet::ReadToken(absl::string_view word) {
  if (absl::ConsumePrefix(&word, kHashed)) {
    Sha256 digest;
    const bool good = word.size() == 2 * digest.size() && std::all_of(word.begin(), word.end(), [](char c) {
                        return absl::ascii_isxdigit(static_cast<unsigned char>(c));
                      });
    if (!good) return absl::InvalidArgumentError("sha256: is not followed by 64 hexadecimal digits");
    for (size_t n = 0; n < digest.size(); ++n) {
      uint32_t byte = 0;
      static_cast<void>(absl::SimpleHexAtoi(word.substr(2 * n, 2), &byte));  // they are digits
      digest[n] = static_cast<uint8_t>(byte);
    }
    return digest;
  }
  if (word.size() < kShortest || word.size() > kLongest) {
    return absl::InvalidArgumentError(
        absl::StrCat("the token has ", word.size(), " characters, not ", kShortest, " to ", kLongest));
  }
  if (!IsToken(word)) {
    return absl::InvalidArgumentError("the token has other characters than A-Z a-z 0-9 - . _ ~ + / =");
  }
  has_plain_tokens_ = true;
  return Sha256Of(word);
}

// Returns entries_.size() if the token is not in the set. No branch depends on secret bytes, and the loop never ends
// early.
size_t TokenSet::IndexOf(const Sha256& sha256) const {
  size_t found = entries_.size();
  for (size_t n = 0; n < entries_.size(); ++n) {
    const size_t equal = CRYPTO_memcmp(entries_[n].sha256.data(), sha256.data(), sha256.size()) == 0;
    const size_t mask = size_t{0} - equal;
    found = (found & ~mask) | (n & mask);
  }
  return found;
}

std::optional<Caller> TokenSet::Find(absl::string_view token) const {
  const size_t found = IndexOf(Sha256Of(token));
  if (found == entries_.size()) return std::nullopt;
  const Entry& entry = entries_[found];
  return Caller{.name = entry.name, .client = entry.name, .limits = entry.limits};
}

}  // namespace latvox
