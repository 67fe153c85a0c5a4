#include "client/tool/cli/common_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <set>

#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/internal/trace_context.h"

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

std::string CheckPositive(const std::string& text) {
  double number = 0;
  if (ParseNumber(text, number) && number > 0) return "";
  return absl::StrCat("\"", text, "\" is not a finite number above 0");
}

std::optional<Shard> ParseShard(const std::string& text) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits('/', 1));
  Shard shard;
  if (!ParseNumber(parts.first, shard.index) || !ParseNumber(parts.second, shard.count)) return std::nullopt;
  if (shard.count < 1 || shard.count > kMaxShards || shard.index >= shard.count) return std::nullopt;
  return shard;
}

std::string CheckShard(const std::string& text) {
  if (ParseShard(text)) return "";
  return absl::StrCat("\"", text, "\" is not I/N with 0 <= I < N <= ", kMaxShards);
}

CLI::Validator Whole(int low, int high) {
  return CLI::Validator(
      [low, high](const std::string& text) -> std::string {
        int64_t number = 0;
        if (ParseNumber(text, number) && number >= low && number <= high) return "";
        return absl::StrCat("\"", text, "\" is not a whole number from ", low, " to ", high);
      },
      "");
}

void Group(CLI::App& command, const char* name) { command.option_defaults()->group(name); }

void AddOutputOption(CLI::App& command, const std::vector<std::string>& extensions, std::vector<std::string>& outputs) {
  const std::string known = absl::StrJoin(extensions, " ");
  const auto check = [extensions, known](const std::string& path) -> std::string {
    const std::string extension = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
    if (std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) return "";
    return absl::StrCat("\"", path, "\": extension \"", extension, "\" is not one of ", known);
  };
  command.add_option("-o,--out", outputs, absl::StrCat("output by extension: ", known, "; may be repeated"))
      ->type_name("OUT")
      ->required()
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false)  // what follows may be a mesh
      ->check(check);
}

void AddSizeOption(CLI::App& command, const std::string& what, int& size) {
  command
      .add_option("--size", size,
                  absl::StrCat(what, ", ", kMinPictureSide, " to ", kMaxPictureSide, " (default: ", size, ")"))
      ->type_name("N")
      ->check(Whole(kMinPictureSide, kMaxPictureSide));
}

void CheckOutputs(const std::vector<std::string>& outputs, const std::string& input, absl::string_view what) {
  std::set<std::filesystem::path> places;
  for (const std::string& output : outputs) {
    if (!places.insert(Place(output)).second) Refuse("--out: \"", output, "\" is given twice");
    if (Place(output) == Place(input)) Refuse("--out: \"", output, "\" is the ", what, " itself");
  }
}

namespace {

void AddCredentials(CLI::App& command, ServerChoice& choice) {
  Credentials& credentials = choice.credentials;
  command.add_flag("--tls", credentials.tls, "encrypt, and believe a server with a certificate of the system's roots")
      ->needs("--server");
  const auto add_file = [&command](const char* name, std::string& path, const char* description) {
    command.add_option(name, path, description)->type_name("FILE")->needs("--server");
  };
  add_file("--tls-ca", credentials.tls_ca_file, "the same with these roots (PEM)");
  add_file("--tls-cert", credentials.tls_cert_file, "certificate of this client (PEM), for a server that wants one");
  add_file("--tls-key", credentials.tls_key_file, "its key (PEM)");
  add_file("--token-file", choice.token_file,
           "file with a bearer token; it is not sent in plain text to another machine");
}

}  // namespace

void AddServerOptions(CLI::App& command, ServerChoice& choice) {
  Group(command, "Server");
  command
      .add_option("--server", choice.address,
                  "the server, as HOST:PORT or unix:PATH, or several with commas (default: a private latvoxd)")
      ->type_name("ADDRESS");
  command.add_option("--timeout", choice.timeout_seconds, "give up after S seconds")
      ->type_name("S")
      ->check(CheckPositive);
  command
      .add_option("--retries", choice.retries,
                  absl::StrCat("times to try again, without progress, when a server is lost or full (default: ",
                               RetryPolicy().max_retries, ")"))
      ->type_name("N")
      ->check(Whole(0, kMaxRetries));
  command.add_option("--threads", choice.threads, "threads of a private latvoxd")
      ->type_name("N")
      ->check(Whole(1, kMaxThreads))
      ->excludes("--server");
  AddCredentials(command, choice);
  command
      .add_option("--traceparent", choice.traceparent,
                  "the W3C trace that the calls belong to, for the server's log (default: $TRACEPARENT)")
      ->type_name("TRACE")
      ->check([](const std::string& text) -> std::string {
        return IsTraceparent(text) ? "" : absl::StrCat("\"", text, "\" is not VERSION-TRACE-SPAN-FLAGS of W3C");
      });
}

}  // namespace latvox::client
