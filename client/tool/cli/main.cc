// The command line tool `latvox`.
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/batch_command.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/commands.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/compare_command.h"
#include "client/tool/cli/convert_command.h"
#include "client/tool/cli/encode_command.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/cli/interrupt.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/pages.h"
#include "client/tool/cli/pixelize_command.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/render_command.h"
#include "client/tool/cli/slice_command.h"
#include "client/tool/cli/terminal.h"
#include "client/tool/cli/view_command.h"
#include "client/tool/cli/voxelize_command.h"
#include "client/tool/confined/reader_main.h"
#include "client/tool/confined/reader_sandbox.h"
#include "client/tool/output/output.h"
#include "client/tool/output/standard_output.h"
#include "client/tool/vdb/vdb.h"
#include "deploy/manual/build_facts.h"
#include "deploy/manual/command_parser.h"
#include "deploy/manual/completions.h"
#include "deploy/process/exhaustion.h"
#include "deploy/process/orderly_end.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

// Prints the line of an error. On a terminal it begins in red.
void Tell(absl::string_view what) {
  std::fprintf(stderr, "%s %s\n", Colored("latvox:", TerminalColor::kRed).c_str(), std::string(what).c_str());
}

ExitStatus Fail(const absl::Status& status) {
  const bool lacks_token = GetErrorDetails(status).reason == "UNAUTHENTICATED";
  Tell(absl::StrCat(ErrorText(status), lacks_token ? "; --token-file names its file" : ""));
  return ExitStatusOf(status);
}

bool quiet = false;  // --quiet was given

ExitStatus Print(const absl::StatusOr<std::string>& text) {
  const absl::Status status = !text.ok() ? text.status() : WriteToStandardOutput(quiet ? "" : *text);
  return status.ok() ? ExitStatus::kDone : Fail(status);
}

absl::StatusOr<std::string> Voxelize(const VoxelizeOptions& options, const Cancellation& cancellation) {
  const auto report = RunVoxelize(options, cancellation);
  if (!report.ok()) return report.status();
  if (options.json) return ToJson(*report) + "\n";
  if (!options.standard_output) return ToText(*report);
  if (!quiet) std::fputs(ToText(*report).c_str(), stderr);
  return "";
}

absl::StatusOr<std::string> Pixelize(const PixelizeOptions& options, const Cancellation& cancellation) {
  const auto report = RunPixelize(options, cancellation);
  if (!report.ok()) return report.status();
  return options.json ? ToJson(*report) + "\n" : ToText(*report);
}

// Prints the summary even if jobs failed, because others may be done.
ExitStatus Batch(const BatchOptions& options, const Cancellation& cancellation) {
  const auto report = RunBatch(options, cancellation);
  if (!report.ok()) return Fail(report.status());
  const ExitStatus printed = Print(options.json ? ToJson(*report) + "\n" : ToText(*report));
  return printed == ExitStatus::kDone ? report->status : printed;
}

ExitStatus Compare(const CompareWords& words, const Cancellation& cancellation) {
  const auto comparison = RunCompare(words, cancellation);
  if (cancellation.cancelled()) return Fail(absl::CancelledError("cancelled"));
  if (!comparison.ok()) return Fail(comparison.status());
  const ExitStatus printed = Print(comparison->text);
  return printed == ExitStatus::kDone && !comparison->equal ? ExitStatus::kOther : printed;
}

std::string Completions(const CommandFacts& facts, const std::string& shell) {
  return shell == "bash" ? BashCompletions(facts) : shell == "zsh" ? ZshCompletions(facts) : FishCompletions(facts);
}

// The commands, their parsed options, and the functions that run them.
class Program {
 public:
  Program() {
    parser_.SetVersion(VersionPage("latvox", FactsOfThisBuild()));
    parser_.SetFooter(Footer());
    AddCallers();
    AddReaders();
    AddQuestions();
  }

  // Throws UsageError.
  ExitStatus Run(std::vector<std::string> words) {
    if (words == std::vector<std::string>{"version"}) words = {"--version"};
    // "help COMMAND" is "COMMAND --help".
    if (!words.empty() && words[0] == "help") {
      words.erase(words.begin());
      if (words.empty() || parser_.HasCommand(words[0])) words.emplace_back("--help");
    }
    if (const std::string page = parser_.Parse(std::move(words)); !page.empty()) return Print(page);
    for (const auto& [command, run] : runs_) {
      if (command->was_given()) return run();
    }
    return Print(Introduction());
  }

 private:
  template <class Words>
  using AddOptions = void (*)(CommandParser&, Words&);

  CommandParser& Add(const char* name, const char* description, std::function<ExitStatus()> run) {
    CommandParser& command = parser_.AddCommand(name, description);
    command.SetFooter(FooterOf(name));
    runs_.emplace_back(&command, std::move(run));
    return command;
  }

  // Adds a command that an interrupt cancels while it runs.
  //   interpret(words)              throws UsageError; its result is passed to `run`
  //   run(options, cancellation)    returns an ExitStatus
  template <class Words, class Interpret, class Run>
  void Add(const char* name, const char* description, AddOptions<Words> add_options, Words& words,
           const Interpret& interpret, const Run& run) {
    CommandParser& command = Add(name, description, [&words, interpret, run] {
      if (quiet) HideProgress();
      const auto options = interpret(words);
      const Cancellation cancellation;
      const Interrupt interrupt(cancellation);
      return run(options, cancellation);
    });
    command.Add({QuietRow(quiet)});
    add_options(command, words);
    if (command.HasOption("--json")) command.Exclude({{"--quiet", "--json"}});
  }

  // Commands that convert files.
  void AddCallers() {
    using Cancel = const Cancellation&;
    Add(
        "voxelize", "Voxelize a mesh file", &AddVoxelizeOptions, voxelize_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) { return Print(Voxelize(options, cancel)); });
    Add(
        "batch", "Voxelize many mesh files", &AddBatchOptions, batch_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) { return Batch(options, cancel); });
    Add(
        "pixelize", "Pixelize a drawing on a plane lattice", &AddPixelizeOptions, pixelize_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) { return Print(Pixelize(options, cancel)); });
    Add(
        "encode", "Write mesh files as one Draco file, a format that servers accept", &AddEncodeOptions, encode_,
        [](const auto& words) { return Interpret(words); },
        [this](const auto& source, Cancel cancel) { return Print(RunEncode(encode_, source, cancel)); });
  }

  // Commands that read .vdb files.
  void AddReaders() {
    using Cancel = const Cancellation&;
    const auto checked = [](const auto& words) {
      Check(words);
      return &words;
    };
    Add("merge", "Join the parts of a voxelization, made with --region, --bounds or --shard", &AddMergeOptions, merge_,
        checked, [](const auto* words, Cancel cancel) { return Print(RunMerge(*words, cancel)); });
    Add(
        "render", "Draw a picture of the voxels of a .vdb or .nvdb file", &AddRenderOptions, render_,
        [](const auto& words) { return Interpret(words); },
        [this](PictureOptions options, Cancel cancel) {
          options.cancellation = cancel;
          return Print(RunRender(render_, options));
        });
    Add("slice", "Draw or list one layer of the voxels of a .vdb or .nvdb file", &AddSliceOptions, slice_, checked,
        [](const auto* words, Cancel cancel) { return Print(RunSlice(*words, cancel)); });
    Add("view", "Write a web page that shows the voxels of a .vdb or .nvdb file", &AddViewOptions, view_, checked,
        [](const auto* words, Cancel cancel) { return Print(RunView(*words, cancel)); });
    Add(
        "convert", "Write the voxels and fields of a .vdb or .nvdb file in other formats", &AddConvertOptions, convert_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) {
          std::vector<Warning> warnings;
          const auto text = RunConvert(options, cancel, warnings);
          for (const Warning& warning : warnings) Tell("warning: " + warning.message);
          return Print(text);
        });
    Add("compare", "Compare two .vdb or .nvdb files", &AddCompareOptions, compare_, checked,
        [](const auto* words, Cancel cancel) { return Compare(*words, cancel); });
  }

  // Commands that print facts.
  void AddQuestions() {
    Add("info", "Print facts about a file that latvox writes, or a mesh",
        [this] { return Print(RunInfo(info_path_, json_)); })
        .Add({{.names = "file",
               .target = &info_path_,
               .help = absl::StrCat("File: ", absl::StrJoin(OutputExtensions(), " "), ", or a mesh"),
               .value = "FILE",
               .checks = {{CheckIsHere}},
               .required = true},
              JsonRow("Print a JSON object", json_)});
    const auto add_call = [this](const char* name, const char* description, auto run) -> CommandParser& {
      CommandParser& command = Add(name, description, [run] {
        const Cancellation cancellation;
        const Interrupt interrupt(cancellation);
        return Print(run(cancellation));
      });
      AddServerOptions(command, server_);
      return command;
    };
    add_call("health", "Ask a server whether it accepts requests", [this](const Cancellation& cancellation) {
      // A private server is always healthy: a probe that forgets the address would never fail.
      if (server_.address.empty()) Refuse("--server is required");
      return RunHealth(server_, cancellation);
    });
    add_call("limits", "Ask a server for its limits", [this](const Cancellation& cancellation) {
      return RunLimits(server_, json_, cancellation);
    }).Add({JsonRow("Print a JSON object", json_)});
    Add("completions", "Print completions for a shell",
        [this] { return Print(Completions(parser_.Describe(), shell_)); })
        .Add({{.names = "shell",
               .target = &shell_,
               .help = "The shell",
               .words = {"bash", "zsh", "fish"},
               .word_help = {"GNU Bourne-again shell", "Z shell", "friendly interactive shell"},
               .required = true}});
    Add("man", "Print the manual page",
        [this] {
          const CommandFacts facts = parser_.Describe();
          return Print(manual_format_ == "markdown" ? ReferenceOf(facts) : ManPageOf(facts));
        })
        .Add({{.names = "format",
               .target = &manual_format_,
               .help = "Format of the page",
               .words = {"troff", "markdown"},
               .word_help = {"for man", "for web pages"},
               .standard = "troff"}});
  }

  CommandParser parser_{"Turn triangle meshes into exact sparse voxels on any 3D lattice", "latvox"};
  std::vector<std::pair<CommandParser*, std::function<ExitStatus()>>> runs_;
  VoxelizeWords voxelize_;
  BatchWords batch_;
  PixelizeWords pixelize_;
  EncodeWords encode_;
  MergeWords merge_;
  RenderWords render_;
  SliceWords slice_;
  CompareWords compare_;
  ConvertWords convert_;
  ViewWords view_;
  std::string info_path_, shell_, manual_format_;
  ServerChoice server_;
  bool json_ = false;
};

ExitStatus Main(int argc, char** argv) {
  EndOrderlyWhenExhausted();
  SpareAddresses();
  // Writing to a closed pipe shall fail that write, not end the process.
  signal(SIGPIPE, SIG_IGN);
  // gRPC repeats its log lines in its statuses, so standard error does not need them.
  setenv("GRPC_VERBOSITY", "NONE", /*overwrite=*/0);
  try {
    return Program().Run({argv + 1, argv + argc});
  } catch (const UsageError& error) {
    Tell(error.what());
    return ExitStatus::kWrongUsage;
  } catch (const std::exception& error) {
    return Fail(StatusOf(error));
  }
}

}  // namespace
}  // namespace latvox::client

const latvox::OrderlyEnd latvox::kOrderlyEnd = {"latvox", static_cast<int>(latvox::client::ExitStatus::kRefused)};

int main(int argc, char** argv) {
  if (latvox::client::IsReader(argc, argv)) latvox::client::ReadForParent(argv, latvox::EndAsUsual);
  const int status = static_cast<int>(latvox::client::Main(argc, argv));
  // Destructors and exit handlers of libraries are left. They take milliseconds, and free what the system frees anyway.
  // A leak check is one of these handlers.
  const bool loads = latvox::client::Vdb::State() == latvox::client::VdbState::kLoading;
  if (loads || latvox::client::AnyAbandoned() || !latvox::client::kAddressSanitizer) _exit(status);
  return status;
}
