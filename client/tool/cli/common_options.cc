#include "client/tool/cli/common_options.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/internal/address.h"
#include "client/internal/trace_context.h"
#include "client/tool/output/output.h"
#include "client/tool/remote/remote_name.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

constexpr int kMaxThreads = 1024, kMaxRetries = 1000000;

}  // namespace

std::filesystem::path Place(const std::string& path) {
  std::error_code error;
  const auto place = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  return error ? std::filesystem::path(path) : place;
}

const Names<UpAxis>& UpNames() {
  static const auto* const kNames = new Names<UpAxis>{{"z", UpAxis::kZ}, {"x", UpAxis::kX}, {"y", UpAxis::kY}};
  return *kNames;
}

absl::Status ToStatus(const UsageError& error) {
  const absl::string_view text = error.what();
  const auto& [option, value, limit, other] = error.details();
  std::string field = option;
  if (const size_t begin = text.find("--"); field.empty() && begin != absl::string_view::npos) {
    const absl::string_view rest = text.substr(begin);
    field = std::string(rest.substr(0, rest.find_first_not_of("-abcdefghijklmnopqrstuvwxyz")));
  }
  absl::Status status = absl::InvalidArgumentError(text);
  SetErrorDetails({"BAD_SPEC", field, value, limit, std::nullopt, other}, status);
  return status;
}

WrongWord CheckPositive(const std::string& text) {
  double number = 0;
  if (ParseNumber(text, number) && number > 0) return "";
  return {absl::StrCat("\"", text, "\" is not a finite number above 0"), text, "0"};
}

std::optional<Shard> ParseShard(const std::string& text) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits('/', 1));
  Shard shard;
  if (!ParseNumber(parts.first, shard.index) || !ParseNumber(parts.second, shard.count)) return std::nullopt;
  if (shard.count < 1 || shard.count > kMaxShards || shard.index >= shard.count) return std::nullopt;
  return shard;
}

WrongWord CheckShard(const std::string& text) {
  if (ParseShard(text)) return "";
  return {absl::StrCat("\"", text, "\" is not I/N with 0 <= I < N <= ", kMaxShards), text, absl::StrCat(kMaxShards)};
}

OptionCheck Whole(int low, int high) {
  return {[low, high](const std::string& text) -> std::string {
            int64_t number = 0;
            if (ParseNumber(text, number) && number >= low && number <= high) return "";
            return absl::StrCat("\"", text, "\" is not a whole number from ", low, " to ", high);
          },
          low == std::numeric_limits<int>::min() ? "" : absl::StrCat(low, " to ", high)};
}

std::string CheckIsHere(const std::string& path) {
  return IsRemote(path) ? absl::StrCat("\"", Redact(path), "\" is a URL; download it") : "";
}

OptionRow GridFileRow(std::string& path, const std::string& name, const std::string& help, const std::string& value) {
  return {.names = name, .target = &path, .help = help, .value = value, .checks = {{CheckIsHere}}, .required = true};
}

OptionRow OutputRow(const std::vector<std::string>& extensions, std::vector<std::string>& outputs, bool several,
                    const std::string& hint) {
  const std::string known = absl::StrJoin(extensions, " ");
  const auto wrong = [extensions, known, hint](const std::string& path) -> WrongWord {
    const std::string shown = WithoutQuery(path), extension = ExtensionOf(shown);
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) return "";
    return {absl::StrCat("\"", shown, "\": extension \"", extension, "\" is not one of ", known, hint), shown, known};
  };
  return {.names = "-o,--out",
          .aliases = "--output",
          .target = &outputs,
          .help = absl::StrCat("Output file: ", known, several ? "; may be repeated" : ""),
          .value = "OUT",
          .checks = {{wrong}},
          .required = true,
          .one_each_time = true};
}

OptionRow SizeRow(const std::string& what, int& size) {
  return {.names = "--size",
          .target = &size,
          .help = what,
          .value = "N",
          .checks = {Whole(kMinPictureSide, kMaxPictureSide)},
          .standard = absl::StrCat(size)};
}

OptionRow QuietRow(bool& quiet) {
  return {.names = "-q,--quiet", .target = &quiet, .help = "Print only errors and warnings"};
}

OptionRow AllowHttpRow(bool& allow_http) {
  return {.names = "--allow-http",
          .target = &allow_http,
          .help = "Allow http: to other machines, which others can read and change; https: is always allowed"};
}

OptionRow JsonRow(const std::string& help, bool& json) { return {.names = "--json", .target = &json, .help = help}; }

void CheckOutputs(const std::vector<std::string>& outputs, const std::string& input, absl::string_view what) {
  std::set<std::filesystem::path> places;
  for (const std::string& output : outputs) {
    std::filesystem::path data = Place(output);  // of a .mhd, they lie beside it
    if (absl::AsciiStrToLower(data.extension().string()) == ".mhd") data.replace_extension(".raw");
    const bool is_new = places.insert(Place(output)).second;
    if (is_new && Place(output) != Place(input) && data != Place(input)) continue;
    const std::string why = is_new ? absl::StrCat("is the ", what, " itself") : "is given twice";
    throw UsageError(absl::StrCat("--out: \"", output, "\" ", why), {"--out", output});
  }
}

namespace {

std::vector<OptionRow> CredentialRows(ServerChoice& choice) {
  Credentials& credentials = choice.credentials;
  return {
      {.names = "--tls",
       .target = &credentials.tls,
       .help = "Encrypt, and verify the server's certificate against the system's roots"},
      {.names = "--tls-ca",
       .target = &credentials.tls_ca_file,
       .help = "Encrypt, and verify the server's certificate against these roots (PEM)",
       .value = "FILE"},
      {.names = "--tls-cert",
       .target = &credentials.tls_cert_file,
       .help = "Certificate of this client (PEM), for a server that asks for one",
       .value = "FILE"},
      {.names = "--tls-key", .target = &credentials.tls_key_file, .help = "Key of --tls-cert (PEM)", .value = "FILE"},
      {.names = "--token-file",
       .target = &choice.token_file,
       .help = "File with a bearer token, which is never sent to another machine in plain text",
       .value = "FILE"}};
}

WrongWord CheckServer(const std::string& text) {
  for (const absl::string_view address : absl::StrSplit(text, ',')) {
    const absl::Status status = CheckAddress(address);
    if (!status.ok()) return {std::string(absl::StripPrefix(status.message(), "address: ")), std::string(address)};
  }
  return "";
}

std::string CheckTraceparent(const std::string& text) {
  return IsTraceparent(text) ? "" : absl::StrCat("\"", text, "\" is not VERSION-TRACE-SPAN-FLAGS of W3C");
}

}  // namespace

void AddServerOptions(CommandParser& command, ServerChoice& choice) {
  command.Add({{.names = "--server",
                .target = &choice.address,
                .help = "Server, HOST:PORT or unix:PATH; several with commas",
                .value = "ADDRESS",
                .group = "Server",
                .checks = {{CheckServer}},
                .standard = "a private latvoxd"},
               {.names = "--timeout",
                .target = &choice.timeout_seconds,
                .help = "Give up after this many seconds",
                .value = "SECONDS",
                .checks = {{CheckPositive}},
                .standard = "no limit"},
               {.names = "--retries",
                .target = &choice.retries,
                .help = "Retries without progress when a server is lost or full",
                .value = "N",
                .checks = {Whole(0, kMaxRetries)},
                .standard = absl::StrCat(RetryPolicy().max_retries)},
               {.names = "--threads",
                .target = &choice.threads,
                .help = "Threads of a private latvoxd",
                .value = "N",
                .checks = {Whole(1, kMaxThreads)},
                .standard = "$LATVOX_THREADS, or all cores"}});
  command.Add(CredentialRows(choice));
  command.Add({{.names = "--traceparent",
                .target = &choice.traceparent,
                .help = "W3C trace context of the calls, for the server's log",
                .value = "TRACE",
                .checks = {{CheckTraceparent}},
                .standard = "$TRACEPARENT"}});
  command.Exclude({{"--threads", "--server"}});
  command.Need({{"--tls", "--server"},
                {"--tls-ca", "--server"},
                {"--tls-cert", "--server"},
                {"--tls-key", "--server"},
                {"--tls-cert", "--tls-key"},
                {"--tls-key", "--tls-cert"},
                {"--token-file", "--server"}});
}

}  // namespace latvox::client
