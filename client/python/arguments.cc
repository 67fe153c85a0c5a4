#include "client/python/arguments.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/internal/printable.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/mesh_options.h"
#include "client/tool/cli/request_rows.h"
#include "latvox/error.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

// The tool's parser, with the words that it writes into.
struct Parser {
  Parser() {
    words.shape.is_for_memory = true;
    AddRequestOptions(command, words);
    command.Add({AllowHttpRow(words.options.remote.allow_http)});
    AddServerOptions(command, words.options.server);
  }
  VoxelizeWords words;
  CommandParser command;
};

// An option and its keyword.
struct Keyword {
  std::string name, option;
  OptionFacts facts;
  bool is_flag() const { return facts.value.empty(); }
  bool is_path() const { return facts.value == "OUT" || absl::StartsWith(facts.value, "FILE"); }
};

// Returns "" for a positional word.
std::string LongName(const OptionFacts& facts) {
  const auto is_long = [](const std::string& name) { return absl::StartsWith(name, "--"); };
  const auto found = std::find_if(facts.names.begin(), facts.names.end(), is_long);
  return found == facts.names.end() ? "" : *found;
}

// Returns the keywords of a command. Positional words have none.
std::vector<Keyword> KeywordsOf(const CommandParser& command) {
  std::vector<Keyword> keywords;
  for (OptionFacts& facts : command.Describe().options) {
    const std::string option = LongName(facts);
    if (option.empty() || option == "--help") continue;
    keywords.push_back({absl::StrReplaceAll(option.substr(2), {{"-", "_"}}), option, std::move(facts)});
  }
  return keywords;
}

const std::vector<Keyword>& AllKeywords() {
  static const auto* const kAll = new std::vector<Keyword>(KeywordsOf(Parser().command));
  return *kAll;
}

const Keyword& Find(const std::string& name, const std::vector<Keyword>& keywords) {
  for (const Keyword& keyword : keywords) {
    if (keyword.name == name) return keyword;
  }
  const auto add = [](std::string* out, const Keyword& keyword) { *out += keyword.name; };
  throw py::type_error(
      absl::StrCat("unknown keyword argument '", name, "'; known are ", absl::StrJoin(keywords, ", ", add)));
}

[[noreturn]] void RefuseType(const Keyword& keyword, py::handle value) {
  throw py::type_error(absl::StrCat(
      keyword.name, ": ", std::string(py::repr(value)),
      keyword.is_flag() ? " is not True or False" : " is not a number, a text, a path or a sequence of these"));
}

// Numbers of numpy, and its arrays, become those of Python with the same value. The nearest float stands for a
// longdouble, which Python lacks.
py::object Plain(py::handle value) {
  if (!py::hasattr(value, "tolist")) return py::reinterpret_borrow<py::object>(value);
  const py::object plain = value.attr("tolist")();
  const bool is_long = py::hasattr(plain, "dtype") && py::str(plain.attr("dtype").attr("kind")).equal(py::str("f"));
  return is_long ? py::float_(plain) : plain;
}

bool IsSequence(py::handle value) { return py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value); }

// Throws the UsageError of a value that Python fails to turn into a text.
[[noreturn]] void RefuseText(const Keyword& keyword, const char* what, const char* limit) {
  PyErr_Clear();
  throw UsageError(absl::StrCat(keyword.option, ": ", what), {keyword.option, "", limit});
}

// Returns the bytes of a text. Those of a path are the bytes of the file's name, which need not be UTF-8.
std::string BytesOf(const Keyword& keyword, py::handle text) {
  PyObject* const bytes = keyword.is_path() ? PyUnicode_EncodeFSDefault(text.ptr())
                                            : PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape");
  if (bytes == nullptr) RefuseText(keyword, "the text has a lone surrogate", "characters of Unicode");
  return py::reinterpret_steal<py::bytes>(bytes);
}

// Numbers are printed so that they read back equal.
std::string TextOf(const Keyword& keyword, py::handle given) {
  py::object value = Plain(given);
  if (py::hasattr(value, "__fspath__")) value = value.attr("__fspath__")();
  if (py::isinstance<py::str>(value)) return BytesOf(keyword, value);
  if (keyword.is_path() && py::isinstance<py::bytes>(value)) return value.cast<std::string>();
  const bool is_number = py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value);
  // A subclass, such as an enum, may print itself in another way.
  const auto print = py::isinstance<py::int_>(value) ? PyLong_Type.tp_repr : PyFloat_Type.tp_repr;
  if (is_number && !py::isinstance<py::bool_>(value)) {
    PyObject* const text = print(value.ptr());
    if (text == nullptr) RefuseText(keyword, "the number has too many digits", "sys.get_int_max_str_digits()");
    return py::reinterpret_steal<py::str>(text);
  }
  if (!IsSequence(value)) RefuseType(keyword, given);
  std::vector<std::string> texts;
  for (const py::handle one : value) {
    texts.push_back(TextOf(keyword, one));
    if (!IsSequence(Plain(one)) && texts.back().find(',') != std::string::npos) {
      const std::string text = absl::StrCat("\"", texts.back(), "\"");
      throw UsageError(absl::StrCat(keyword.option, ": ", text, " has a comma, which would make several of it"),
                       {keyword.option, texts.back(), "no comma"});
    }
  }
  return absl::StrJoin(texts, ",");
}

// Appends the words of a command line for a keyword.
void AddWords(const Keyword& keyword, const CommandParser& command, py::handle given, std::vector<std::string>& words) {
  const py::object value = Plain(given);
  if (keyword.is_flag()) {
    if (!py::isinstance<py::bool_>(value)) RefuseType(keyword, given);
    const std::string no = "--no-" + keyword.option.substr(2);
    if (value.cast<bool>()) words.push_back(keyword.option);
    if (!value.cast<bool>() && command.HasOption(no)) words.push_back(no);  // others are off by default
    return;
  }
  const bool has_several = keyword.facts.several && IsSequence(value);
  for (const py::handle one : has_several ? value : py::object(py::make_tuple(value))) {
    const std::string text = TextOf(keyword, one);
    if (text.empty()) throw UsageError(keyword.option + ": is empty");
    if (text.find('\0') != std::string::npos) {  // the system would end the name of a file there
      const std::string shown = Printable(text);
      throw UsageError(absl::StrCat(keyword.option, ": \"", shown, "\" has a NUL character; a text has no NUL"),
                       {keyword.option, shown, "no NUL"});
    }
    words.push_back(absl::StrCat(keyword.option, "=", text));
  }
}

// Returns the words of a command line for the keywords.
std::vector<std::string> WordsOf(const py::dict& given, const std::vector<Keyword>& keywords,
                                 const CommandParser& command) {
  std::vector<std::string> words;
  for (const auto& [name, value] : given) {
    if (!value.is_none()) AddWords(Find(py::str(name), keywords), command, value, words);
  }
  return words;
}

// Returns the error of a command's words. `positional` is the name of a word without an option, whose keyword this is.
absl::Status Named(const UsageError& error, const std::string& positional, const std::string& keyword) {
  const absl::Status status = ToStatus(error);
  ErrorDetails details = GetErrorDetails(status);
  if (details.field != positional) return status;
  details.field = keyword;
  absl::Status named(status.code(), absl::StrCat(keyword, absl::StripPrefix(status.message(), positional)));
  SetErrorDetails(details, named);
  return named;
}

}  // namespace

py::dict Keywords() {
  VoxelizeWords words;
  CommandParser request;
  AddRequestOptions(request, words);
  const auto has_server = [](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), "--server") != names.end();
  };
  py::dict all;
  for (const auto& [name, option, facts] : AllKeywords()) {
    const bool chooses_server = option == "--server" || has_server(facts.needs) || has_server(facts.excludes);
    const char* const scope = request.HasOption(option) ? "request" : chooses_server ? "connection" : "call";
    all[py::str(name)] = py::dict(py::arg("help") = WithKeywords(facts.description), py::arg("value") = facts.value,
                                  py::arg("standard") = WithKeywords(facts.standard), py::arg("scope") = scope);
  }
  return all;
}

absl::StatusOr<VoxelizeOptions> ParseKeywords(const py::dict& keywords, const std::vector<std::string>& paths) try {
  Parser parser;
  parser.command.Parse(WordsOf(keywords, AllKeywords(), parser.command));
  parser.words.options.mesh.paths = paths;
  NameRemoteFiles(parser.words.options);
  VoxelizeOptions options = InterpretRequest(parser.words);
  CheckMeshPaths(options.mesh, options.outputs);
  return options;
} catch (const UsageError& error) {
  return ToStatus(error);
}

absl::StatusOr<ConvertOptions> ParseConvertKeywords(const py::dict& keywords, const std::string& path) try {
  ConvertWords words;
  CommandParser command;
  AddConvertOptions(command, words);
  std::vector<std::string> line = WordsOf(keywords, KeywordsOf(command), command);
  line.push_back(path);
  command.Parse(std::move(line));
  return Interpret(words);
} catch (const UsageError& error) {
  return Named(error, "IN.vdb", "path");
}

absl::StatusOr<MergeWords> ParseMergeWords(const std::vector<std::string>& parts, const std::string& out) try {
  MergeWords words;
  CommandParser command;
  AddMergeOptions(command, words);
  std::vector<std::string> line = parts;
  line.push_back("--out=" + out);
  line.emplace_back("--json");
  command.Parse(std::move(line));
  client::Check(words);
  return words;
} catch (const UsageError& error) {
  return Named(error, "PART.vdb", "parts");
}

std::string WithKeywords(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> names = {{"latvox voxelize", "latvox.voxelize"}};
  for (const Keyword& keyword : AllKeywords()) names.emplace_back(keyword.option, keyword.name);
  return absl::StrReplaceAll(text, names);
}

}  // namespace latvox::client::python
