#include "client/tool/cli/option_words.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "client/tool/cli/request_words.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

// Fields that are options of their own. VoxelizeSpec in the protocol has them all.
constexpr std::pair<absl::string_view, const char*> kOptions[] = {
    {"algorithm", "--algorithm"},
    {"allow_outside", "--allow-outside"},
    {"band", "--band"},
    {"band.voxels", "--band"},
    {"band.width", "--band"},
    {"basis", "--basis"},
    {"bounds", "--bounds"},
    {"bounds.max", "--bounds"},
    {"bounds.min", "--bounds"},
    {"connected.allow_outside", "--allow-outside"},
    {"connected.close", "--close"},
    {"connected.seed", "--seed"},
    {"enclosed.close", "--close"},
    {"enclosed.labels", "--labels"},
    {"enclosed.leak_from", "--leak-from"},
    {"enclosed.priority", "--priority"},
    {"encoding", "--encoding"},
    {"fields", "--fields"},
    {"force_open", "--force-open"},
    {"fraction_labels", "--fraction-labels"},
    {"fraction_n", "--fields"},
    {"lattice", "--lattice"},
    {"lattice.basis", "--basis"},
    {"lattice.named", "--lattice"},
    {"leak_from", "--leak-from"},
    {"links.side", "--side"},
    {"minimal", "--minimal"},
    {"origin", "--origin"},
    {"placement", "--placement"},
    {"region", "--region"},
    {"region.max", "--region"},
    {"region.min", "--region"},
    {"resolution", "--resolution"},
    {"separability", "--separability"},
    {"shard", "--shard"},
    {"shard.count", "--shard"},
    {"shard.index", "--shard"},
    {"signed_distance", "--signed"},
    {"solid.force_open", "--force-open"},
    {"solid.labels", "--labels"},
    {"solid.priority", "--priority"},
    {"solid.rule", "--rule"},
    {"interior_rule", "--rule"},
    {"verify", "--verify"},
    {"voxel_size", "--voxel-size"},
};

// Fields that make up a set, which is one option.
constexpr absl::string_view kOfSets[] = {"supercover",       "solid",     "solid.surface", "enclosed",
                                         "enclosed.surface", "connected", "links"};

bool IsSet(absl::string_view field) {
  for (const absl::string_view one : kOfSets) {
    if (one == field) return true;
  }
  return false;
}

// Returns the option of a field or of its coordinate: of "connected.seed" and "connected.seed.x".
std::optional<std::string> OptionOfField(absl::string_view field) {
  for (const absl::string_view coordinate : {"", ".x", ".y", ".z", ".i", ".j", ".k"}) {
    absl::string_view name = field;
    if (!absl::ConsumeSuffix(&name, coordinate)) continue;
    if (IsSet(name)) return "--set";
    for (const auto& [known, option] : kOptions) {
      if (known == name) return option;
    }
  }
  return std::nullopt;
}

// Removes the value after a field that is a flag, or part of a set's name.
void DropValue(absl::string_view option, absl::string_view& rest) {
  if (option == "--set" && !absl::ConsumePrefix(&rest, " none")) absl::ConsumePrefix(&rest, " supercover");
  if (option == "--force-open" || option == "--signed") absl::ConsumePrefix(&rest, " true");
}

// Returns whether the word after this text is a field, even if it is a word of English as well.
bool NamesField(absl::string_view before) {
  return before.empty() || absl::EndsWith(before, "not together with ") || absl::EndsWith(before, " among ");
}

std::string TextWithOptions(absl::string_view text, const std::string& set) {
  const auto is_of_word = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.';
  };
  std::string result;
  for (absl::string_view rest = text; !rest.empty();) {
    size_t length = 0;
    while (length < rest.size() && is_of_word(rest[length])) ++length;
    const absl::string_view before = text.substr(0, text.size() - rest.size());
    const absl::string_view word = absl::StripSuffix(rest.substr(0, length), ".");
    const bool is_field = NamesField(before) || word.find_first_of("._") != absl::string_view::npos;
    const std::optional<std::string> option = is_field ? OptionOfField(word) : std::nullopt;
    const size_t taken = option ? word.size() : std::max<size_t>(length, 1);
    rest.remove_prefix(taken);
    if (!option) {
      absl::StrAppend(&result, text.substr(before.size(), taken));
      continue;
    }
    DropValue(*option, rest);
    absl::StrAppend(&result, *option, *option == "--set" ? " " + set : "");
  }
  return result;
}

}  // namespace

absl::Status WithOptions(const absl::Status& error, const VoxelizeRequest& request) {
  if (!absl::IsInvalidArgument(error) && !absl::IsResourceExhausted(error)) return error;
  absl::Status translated(error.code(), TextWithOptions(error.message(), NameOfSet(request.set)));
  ErrorDetails details = GetErrorDetails(error);
  for (std::string* const field : {&details.field, &details.other}) {
    if (const auto option = OptionOfField(*field)) *field = *option;
  }
  SetErrorDetails(details, translated);
  return translated;
}

}  // namespace latvox::client
