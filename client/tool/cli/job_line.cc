#include "client/tool/cli/job_line.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/json/json.h"
#include "client/mesh_files/input.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/file_url.h"
#include "client/tool/cli/remote_names.h"
#include "client/tool/cli/request_rows.h"
#include "deploy/manual/nearest_word.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

enum class Kind { kText, kNumber, kNumberOrText, kNumberOrNumbers, kNumbers, kFlag, kTexts, kNumbersOrTexts };

constexpr std::pair<const char*, Kind> kLineFields[] = {
    {"lattice", Kind::kText},
    {"basis", Kind::kNumbers},
    {"voxel_size", Kind::kNumberOrNumbers},
    {"resolution", Kind::kNumber},
    {"origin", Kind::kNumbers},
    {"placement", Kind::kText},
    {"align", Kind::kText},
    {"separability", Kind::kNumber},
    {"minimal", Kind::kFlag},
    {"algorithm", Kind::kText},
    {"set", Kind::kText},
    {"rule", Kind::kText},
    {"force_open", Kind::kFlag},
    {"band", Kind::kNumberOrText},
    {"side", Kind::kText},
    {"seed", Kind::kNumbers},
    {"close", Kind::kNumber},
    {"leak_from", Kind::kNumbers},
    {"allow_outside", Kind::kFlag},
    {"fields", Kind::kTexts},
    {"labels", Kind::kText},
    {"priority", Kind::kNumbersOrTexts},
    {"fraction_labels", Kind::kNumbersOrTexts},
    {"signed", Kind::kFlag},
    {"alpha_cutoff", Kind::kNumber},
    {"upload", Kind::kText},
    {"quantization", Kind::kNumberOrText},
    {"verify", Kind::kFlag},
    {"region", Kind::kNumbers},
    {"bounds", Kind::kNumbers},
    {"shard", Kind::kText},
    {"encoding", Kind::kText},
    {"up_axis", Kind::kText},
    {"scale", Kind::kNumber},
    {"skip_bad", Kind::kFlag},
    {"input_format", Kind::kText},
    {"weld_report", Kind::kFlag},
    {"strict", Kind::kFlag},
    {"npy", Kind::kText},
    {"array", Kind::kTexts},
    {"dims", Kind::kNumbers},
    {"pad", Kind::kNumber},
};

constexpr const char* kTypes[] = {"a non-empty string",
                                  "a number",
                                  "a number or a string",
                                  "a number or an array of numbers",
                                  "an array of numbers",
                                  "true or false",
                                  "a string or an array of strings",
                                  "a number, a string or an array of these"};

template <class... Parts>
absl::Status Wrong(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

// Returns the value as JSON, cut to a readable length.
std::string Show(const SortedJson& value) {
  constexpr size_t kMost = 100;
  const std::string text = Redact(value.dump(-1, ' ', false, SortedJson::error_handler_t::replace));
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

absl::Status WrongType(const std::string& field, const SortedJson& value, const char* type) {
  return Wrong(field, ": ", Show(value), " is not ", type);
}

bool IsText(const SortedJson& value) { return value.is_string() && !value.get_ref<const std::string&>().empty(); }

bool Is(const SortedJson& value, Kind kind) {
  const auto is_number = [](const SortedJson& element) { return element.is_number(); };
  const auto is_either = [](const SortedJson& element) { return Is(element, Kind::kNumberOrText); };
  switch (kind) {
    case Kind::kText:
      return IsText(value);
    case Kind::kNumber:
      return value.is_number();
    case Kind::kNumberOrText:
      return value.is_number() || IsText(value);
    case Kind::kNumberOrNumbers:
      return value.is_number() || Is(value, Kind::kNumbers);
    case Kind::kNumbers:
      return value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), is_number);
    case Kind::kFlag:
      return value.is_boolean();
    case Kind::kTexts:
      return IsText(value) || (value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), IsText));
    case Kind::kNumbersOrTexts:
      return is_either(value) ||
             (value.is_array() && !value.empty() && std::all_of(value.begin(), value.end(), is_either));
  }
  return false;
}

// Returns the value as a word of the option. Numbers are printed so that they read back equal.
std::string TextOf(const SortedJson& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  return absl::StrJoin(value, ",", [](std::string* out, const SortedJson& element) { *out += TextOf(element); });
}

// Returns the paths and URLs of meshes as they are given, without queries.
std::string MeshText(const SortedJson& given) {
  const auto append = [](std::string* out, const SortedJson& one) { *out += WithoutQuery(one.get<std::string>()); };
  return given.is_array() ? absl::StrJoin(given, " + ", append) : WithoutQuery(given.get<std::string>());
}

// Returns the library's error without its line number, which is always 1.
absl::Status NoJson(const SortedJson::exception& error) {
  const absl::string_view what = error.what();
  const size_t column = what.find("column "), at = column == absl::string_view::npos ? what.find("] ") + 2 : column;
  return Wrong("not JSON: ", what.substr(at));
}

absl::StatusOr<SortedJson> ParseObject(absl::string_view line) try {
  using Event = SortedJson::parse_event_t;
  constexpr int kDeepest = 1;  // of a field's array; deeper nesting would cost stack
  std::set<std::string> keys;
  std::string twice;
  bool deep = false;
  const auto see = [&](int depth, Event event, SortedJson& parsed) {
    if (depth == 1 && event == Event::key && !keys.insert(parsed.get<std::string>()).second) {
      twice = parsed.get<std::string>();
    }
    const bool too_deep = depth > kDeepest && (event == Event::array_start || event == Event::object_start);
    deep = deep || too_deep;
    return !too_deep;
  };
  SortedJson object = SortedJson::parse(line, see);
  if (deep) return Wrong("arrays and objects cannot be nested within a field");
  if (!object.is_object()) return Wrong(Show(object), " is not a JSON object");
  if (!twice.empty()) return Wrong(twice, ": is given twice");
  return object;
} catch (const SortedJson::exception& error) {
  return NoJson(error);
}

// Returns the name of an output in normal form, or its URL.
absl::StatusOr<std::string> OutputName(const SortedJson& value) {
  if (!IsText(value)) return WrongType("out", value, "a file name or an array of file names");
  if (IsRemote(value.get<std::string>())) return value.get<std::string>();
  const std::filesystem::path path = value.get<std::string>(), name = path.lexically_normal();
  if (absl::StrContains(path.string(), '\0') || path.is_absolute() || *name.begin() == ".." || !name.has_filename()) {
    return Wrong("out: ", Show(value), " is not a file below the output directory");
  }
  return name.string();
}

absl::StatusOr<std::vector<std::string>> OutputNames(const SortedJson& object, const std::string& mesh,
                                                     RemoteNames& remote) {
  SortedJson given = object.value("out", SortedJson(std::filesystem::path(mesh).stem().string() + ".vdb"));
  if (!given.is_array()) given = SortedJson::array({given});
  if (given.empty()) return WrongType("out", given, "a file name or an array of file names");
  std::vector<std::string> names;
  for (const SortedJson& one : given) {
    auto name = OutputName(one);
    if (!name.ok()) return name.status();
    names.push_back(*std::move(name));
  }
  if (auto status = NameRemoteOutputs(names, remote); !status.ok()) return Wrong("out: ", status.message());
  return names;
}

absl::StatusOr<std::vector<std::string>> MeshPaths(const SortedJson& given, const std::string& folder,
                                                   RemoteNames& remote) {
  if (!Is(given, Kind::kTexts)) return WrongType("mesh", given, "a path or a URL, or an array of these");
  std::vector<std::string> paths;
  for (const SortedJson& one : given.is_array() ? given : SortedJson::array({given})) {
    if (IsRemote(one.get<std::string>())) {
      paths.push_back(one.get<std::string>());
      continue;
    }
    auto path = PathOf(one.get<std::string>(), folder);
    if (!path.ok()) return Wrong("mesh: ", path.status().message());
    // A job cannot read standard input.
    paths.push_back(*path == kStandardInput ? "./-" : *std::move(path));
  }
  if (auto status = NameRemotes(paths, remote); !status.ok()) return Wrong("mesh: ", status.message());
  return paths;
}

// "voxel_size" to "--voxel-size".
std::string OptionOf(absl::string_view field) { return absl::StrCat("--", absl::StrReplaceAll(field, {{"_", "-"}})); }

absl::Status Unknown(const std::string& field) {
  std::vector<std::string> names = {"mesh", "out", "id"};
  for (const auto& entry : kLineFields) names.emplace_back(entry.first);
  if (const auto nearest = NearestWord(field, names)) {
    return Wrong(field, ": unknown field; did you mean ", *nearest, "?");
  }
  return Wrong(field, ": unknown field; the fields are ", absl::StrJoin(names, ", "));
}

// Returns the words of a command line for the request of the object, without outputs.
absl::StatusOr<std::vector<std::string>> Words(const SortedJson& object, const CommandParser& parser) {
  std::vector<std::string> words;
  for (const auto& [field, value] : object.items()) {
    if (field == "mesh" || field == "out" || field == "id") continue;
    const auto is_it = [name = field](const auto& entry) { return entry.first == name; };
    const auto entry = std::find_if(std::begin(kLineFields), std::end(kLineFields), is_it);
    if (entry == std::end(kLineFields)) return Unknown(field);
    const Kind kind = entry->second;
    if (!Is(value, kind)) return WrongType(field, value, kTypes[static_cast<size_t>(kind)]);
    const std::string option = OptionOf(field);
    if (kind != Kind::kFlag) {
      words.push_back(absl::StrCat(option, "=", TextOf(value)));
    } else if (value.get<bool>()) {
      words.push_back(option);
    } else if (const std::string no = "--no-" + field; parser.HasOption(no)) {
      words.push_back(no);
    }  // a flag without a negation is off by default
  }
  return words;
}

}  // namespace

JobParser::JobParser(std::string folder, std::string directory)
    : folder_(std::move(folder)), directory_(std::move(directory)) {
  AddRequestOptions(parser_, words_);
  names_.emplace_back("--out", "out");
  for (const auto& [field, kind] : kLineFields) names_.emplace_back(OptionOf(field), field);
}

absl::StatusOr<Job> JobParser::Parse(absl::string_view line) {
  const auto object = ParseObject(line);
  if (!object.ok()) return object.status();
  const SortedJson mesh = object->value("mesh", SortedJson()), id = object->value("id", SortedJson());
  if (object->contains("id") && !IsText(id)) return WrongType("id", id, kTypes[0]);
  RemoteNames remote;
  auto paths = MeshPaths(mesh, folder_, remote);
  if (!paths.ok()) return paths.status();
  auto names = OutputNames(*object, paths->front(), remote);
  if (!names.ok()) return names.status();
  auto words = Words(*object, parser_);
  if (!words.ok()) return words.status();
  for (const std::string& name : *names) words->push_back("--out=" + name);
  words_ = VoxelizeWords();
  try {
    parser_.Parse(*std::move(words));
    words_.options.mesh.paths = *std::move(paths);
    words_.options.remote = std::move(remote);
    if (std::string& align = words_.options.align; !align.empty()) {
      auto place = PathOf(align, folder_);
      if (!place.ok()) return Wrong("align: ", place.status().message());
      align = *std::move(place);
    }
    for (std::string& out : words_.options.outputs) {
      if (!IsRemote(out)) out = (std::filesystem::path(directory_) / out).string();
    }
    return Job{id.is_null() ? names->front() : id.get<std::string>(), MeshText(mesh), *std::move(names),
               InterpretRequest(words_)};
  } catch (const UsageError& error) {
    return WithFields(ToStatus(error));
  }
}

absl::Status JobParser::WithFields(const absl::Status& error) const {
  absl::Status translated(error.code(), absl::StrReplaceAll(error.message(), names_));
  ErrorDetails details = GetErrorDetails(error);
  for (std::string* const text : {&details.field, &details.limit, &details.other}) {
    *text = absl::StrReplaceAll(*text, names_);
  }
  SetErrorDetails(details, translated);
  return translated;
}

absl::Status CheckPlaces(const Job& job) try {
  for (const std::string& mesh : job.options.mesh.paths) CheckOutputs(job.options.outputs, mesh, "mesh");
  return absl::OkStatus();
} catch (const UsageError& error) {
  return Wrong(absl::StrReplaceAll(error.what(), {{"--out", "out"}}));
}

}  // namespace latvox::client
