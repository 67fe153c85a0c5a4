// Options and checks that several commands share.
#ifndef LATVOX_CLIENT_TOOL_CLI_COMMON_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_COMMON_OPTIONS_H_

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/tool/cli/session.h"
#include "deploy/manual/command_parser.h"
#include "deploy/manual/option_row.h"
#include "latvox/mesh_files/up_axis.h"
#include "latvox/types.h"

namespace latvox::client {

// Limits of --resolution.
inline constexpr int kMinResolution = 2, kMaxResolution = 65536;
inline constexpr uint32_t kDefaultResolution = 256;
inline constexpr int kMinPictureSide = 16, kMaxPictureSide = 8192;
inline constexpr uint32_t kMaxShards = 1 << 20;

// Parses a number. Returns false if the text is not one; floating-point numbers must be finite.
template <class T>
bool ParseNumber(absl::string_view text, T& number) {
  text = absl::StripAsciiWhitespace(text);
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(number);
  return true;
}

// Parses "1,2,3" as exactly N numbers.
template <class T, size_t N>
bool ParseNumbers(const std::string& text, std::array<T, N>& numbers) {
  const std::vector<absl::string_view> words = absl::StrSplit(text, ',');
  if (words.size() != N) return false;
  for (size_t n = 0; n < N; ++n) {
    if (!ParseNumber(words[n], numbers[n])) return false;
  }
  return true;
}

template <class T, size_t N>
std::string CheckNumbers(const std::string& text) {
  std::array<T, N> numbers;
  if (ParseNumbers(text, numbers)) return "";
  const char* kind = std::is_integral_v<T> ? " 32-bit integers" : " finite numbers";
  return absl::StrCat("\"", text, "\" is not ", N, kind, " with commas between them");
}

WrongWord CheckPositive(const std::string& text);

// Parses "I/N". Returns nothing if the text is anything else.
std::optional<Shard> ParseShard(const std::string& text);
WrongWord CheckShard(const std::string& text);

// Returns the check for a whole number from low to high.
OptionCheck Whole(int low, int high);

// Names of the values of an enumeration.
template <class T>
using Names = std::vector<std::pair<std::string, T>>;

// Returns the names and values of a table of common lattices.
template <class Table>
auto NamesOfLattices(const Table& table) {
  Names<decltype(table[0].lattice)> names;
  for (const auto& row : table) names.emplace_back(row.name, row.lattice);
  return names;
}

template <class T>
std::vector<std::string> WordsOf(const Names<T>& names) {
  std::vector<std::string> words;
  for (const auto& [word, unused] : names) words.push_back(word);
  return words;
}

// Returns the value of this name, or the first value if there is no such name.
template <class T>
T ValueNamed(const Names<T>& names, const std::string& word) {
  for (const auto& [name, value] : names) {
    if (name == word) return value;
  }
  return names.front().second;
}

const Names<UpAxis>& UpNames();

// Returns INVALID_ARGUMENT with the same text, and with option, value and limit as details. Without an option in the
// details, it is the first that the text names.
absl::Status ToStatus(const UsageError& error);

// Throws UsageError with this text. Interpret calls it if words do not go together.
template <class... Parts>
[[noreturn]] void Refuse(const Parts&... parts) {
  throw UsageError(absl::StrCat(parts...));
}

// Returns the absolute path. Links are resolved as far as the path exists.
std::filesystem::path Place(const std::string& path);

// Checks a file that must be on this machine: only meshes, and the outputs of a request, may be elsewhere. Returns the
// error, or "".
std::string CheckIsHere(const std::string& path);

// The row of a command's input: a grid on this machine.
OptionRow GridFileRow(std::string& path, const std::string& name = "file",
                      const std::string& help = "OpenVDB or NanoVDB file", const std::string& value = "IN.vdb");

// -o, --out
//   several   whether the command writes more than one output
//   hint      what the error of another extension ends with
OptionRow OutputRow(const std::vector<std::string>& extensions, std::vector<std::string>& outputs, bool several,
                    const std::string& hint = "");

// --size of a picture
OptionRow SizeRow(const std::string& what, int& size);

// -q, --quiet
OptionRow QuietRow(bool& quiet);

// --allow-http, of commands with URLs
OptionRow AllowHttpRow(bool& allow_http);

// --json
OptionRow JsonRow(const std::string& help, bool& json);

// Throws UsageError if an output is given twice or is the input, which the message calls `what`.
void CheckOutputs(const std::vector<std::string>& outputs, const std::string& input, absl::string_view what);

// Adds --server and the options of the connection.
void AddServerOptions(CommandParser& command, ServerChoice& choice);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COMMON_OPTIONS_H_
