#include "client/tool/cli/remote_names.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/tool/output/output.h"

namespace latvox::client {

absl::Status NameRemotes(std::vector<std::string>& words, RemoteNames& remote) {
  for (std::string& word : words) {
    if (!IsRemote(word)) continue;
    auto parsed = ParseRemote(word);
    if (!parsed.ok()) return parsed.status();
    word = parsed->name;
    const auto [entry, fresh] = remote.objects.emplace(word, *parsed);
    if (!fresh && entry->second.url != parsed->url) {
      return absl::InvalidArgumentError(absl::StrCat("\"", word, "\": is given twice, with another query"));
    }
  }
  return absl::OkStatus();
}

absl::Status NameRemoteOutputs(std::vector<std::string>& words, RemoteNames& remote) {
  if (auto status = NameRemotes(words, remote); !status.ok()) return status;
  const auto formats = StreamedFormats();
  for (const std::string& word : words) {
    const std::string extension = ExtensionOf(word);
    const auto is_it = [&](const auto& format) { return "." + format.first == extension; };
    if (!IsRemote(word) || !HasExtension(word, OutputExtensions())) continue;
    if (std::any_of(formats.begin(), formats.end(), is_it)) continue;
    return absl::InvalidArgumentError(absl::StrCat("\"", word, "\": a ", extension, " is not one file"));
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
