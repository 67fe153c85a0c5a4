#include "client/tool/cli/remote_names.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "client/tool/output/output.h"
#include "latvox/error.h"

namespace latvox::client {

namespace {

constexpr char kMesh[] = "mesh", kOut[] = "--out";

absl::Status WithDetails(absl::Status error, const char* field, const std::string& value) {
  SetErrorDetails({"BAD_SPEC", field, value, "", std::nullopt}, error);
  return error;
}

absl::Status Name(const char* field, std::vector<std::string>& words, RemoteNames& remote) {
  for (std::string& word : words) {
    if (!IsRemote(word)) continue;
    auto parsed = ParseRemote(word);
    if (!parsed.ok()) return WithDetails(parsed.status(), field, Redact(word));
    word = parsed->name;
    const auto [entry, fresh] = remote.objects.emplace(word, *parsed);
    if (!fresh && entry->second.url != parsed->url) {
      const std::string text = absl::StrCat("\"", word, "\": is given twice, with another query");
      return WithDetails(absl::InvalidArgumentError(text), field, word);
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status NameRemotes(std::vector<std::string>& words, RemoteNames& remote) { return Name(kMesh, words, remote); }

absl::Status NameRemoteOutputs(std::vector<std::string>& words, RemoteNames& remote) {
  if (auto status = Name(kOut, words, remote); !status.ok()) return status;
  const auto formats = StreamedFormats();
  for (const std::string& word : words) {
    const std::string extension = ExtensionOf(word);
    const auto is_it = [&](const auto& format) { return "." + format.first == extension; };
    if (!IsRemote(word) || !HasExtension(word, OutputExtensions())) continue;
    if (std::any_of(formats.begin(), formats.end(), is_it)) continue;
    const std::string text = absl::StrCat("\"", word, "\": a ", extension, " is not one file");
    return WithDetails(absl::InvalidArgumentError(text), kOut, word);
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
