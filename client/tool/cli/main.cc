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

#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/batch_command.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/commands.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/compare_command.h"
#include "client/tool/cli/encode_command.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/cli/interrupt.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/pages.h"
#include "client/tool/cli/pixelize_command.h"
#include "client/tool/cli/render_command.h"
#include "client/tool/cli/slice_command.h"
#include "client/tool/cli/terminal.h"
#include "client/tool/cli/view_command.h"
#include "client/tool/cli/voxelize_command.h"
#include "deploy/manual/command_parser.h"
#include "deploy/manual/completions.h"

namespace latvox::client {
namespace {

// An error's line, its beginning in red on a terminal.
void Tell(absl::string_view what) {
  std::fprintf(stderr, "%s %s\n", Coloured("latvox:", Colour::kRed).c_str(), std::string(what).c_str());
}

ExitStatus Fail(const absl::Status& status) {
  Tell(ErrorText(status));
  return ExitStatusOf(status);
}

ExitStatus Print(const absl::StatusOr<std::string>& text) {
  if (!text.ok()) return Fail(text.status());
  if (std::fputs(text->c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
    return Fail(absl::UnknownError("standard output cannot be written"));
  }
  return ExitStatus::kDone;
}

absl::StatusOr<std::string> Voxelize(const VoxelizeOptions& options, const Cancellation& cancellation) {
  const auto report = RunVoxelize(options, cancellation);
  if (!report.ok()) return report.status();
  return options.json ? ToJson(*report) + "\n" : ToText(*report);
}

absl::StatusOr<std::string> Pixelize(const PixelizeOptions& options, const Cancellation& cancellation) {
  const auto report = RunPixelize(options, cancellation);
  if (!report.ok()) return report.status();
  return options.json ? ToJson(*report) + "\n" : ToText(*report);
}

// Other jobs may be done although some failed: both are told.
ExitStatus Batch(const BatchOptions& options, const Cancellation& cancellation) {
  const auto report = RunBatch(options, cancellation);
  if (!report.ok()) return Fail(report.status());
  const ExitStatus printed = Print(options.json ? ToJson(*report) + "\n" : ToText(*report));
  return printed == ExitStatus::kDone ? report->status : printed;
}

ExitStatus Compare(const CompareWords& words, const Cancellation& cancellation) {
  const auto comparison = RunCompare(words);
  if (cancellation.cancelled()) return Fail(absl::CancelledError("cancelled"));
  if (!comparison.ok()) return Fail(comparison.status());
  const ExitStatus printed = Print(comparison->text);
  return printed == ExitStatus::kDone && !comparison->equal ? ExitStatus::kOther : printed;
}

std::string Completions(const CommandFacts& facts, const std::string& shell) {
  return shell == "bash" ? BashCompletions(facts) : shell == "zsh" ? ZshCompletions(facts) : FishCompletions(facts);
}

// The commands, what parsing them fills, and what runs them.
class Program {
 public:
  Program() {
    parser_.SetVersion("latvox " LATVOX_VERSION);
    parser_.SetFooter(Footer());
    AddCallers();
    AddReaders();
    AddQuestions();
  }

  // Throws UsageError.
  ExitStatus Run(std::vector<std::string> words) {
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

  // One that an interrupt cancels, once its words are understood.
  //   interpret(words)              throws UsageError; what it returns is passed to `run`
  //   run(options, cancellation)    returns an ExitStatus
  template <class Words, class Interpret, class Run>
  void Add(const char* name, const char* description, AddOptions<Words> add_options, Words& words,
           const Interpret& interpret, const Run& run) {
    CommandParser& command = Add(name, description, [&words, interpret, run] {
      const auto options = interpret(words);
      const Cancellation cancellation;
      const Interrupt interrupt(cancellation);
      return run(options, cancellation);
    });
    add_options(command, words);
  }

  // Commands that turn files into files.
  void AddCallers() {
    using Cancel = const Cancellation&;
    Add(
        "voxelize", "voxelize a mesh file", &AddVoxelizeOptions, voxelize_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) { return Print(Voxelize(options, cancel)); });
    Add(
        "batch", "voxelize many mesh files", &AddBatchOptions, batch_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) { return Batch(options, cancel); });
    Add(
        "pixelize", "pixelize a drawing: the same in the plane", &AddPixelizeOptions, pixelize_,
        [](const auto& words) { return Interpret(words); },
        [](const auto& options, Cancel cancel) { return Print(Pixelize(options, cancel)); });
    Add(
        "encode", "write mesh files as one Draco file, as servers take it", &AddEncodeOptions, encode_,
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
    Add("merge", "join parts of a voxelization: .vdb files of --region, --bounds or --shard", &AddMergeOptions, merge_,
        checked, [](const auto* words, Cancel cancel) { return Print(RunMerge(*words, cancel)); });
    Add(
        "render", "draw a picture of a .vdb file's voxels", &AddRenderOptions, render_,
        [](const auto& words) { return Interpret(words); },
        [this](PictureOptions options, Cancel cancel) {
          options.cancellation = cancel;
          return Print(RunRender(render_, options));
        });
    Add("slice", "draw one layer of a .vdb file's voxels, or list them", &AddSliceOptions, slice_, checked,
        [](const auto* words, Cancel cancel) { return Print(RunSlice(*words, cancel)); });
    Add("view", "make a page that shows a .vdb file's voxels in a browser", &AddViewOptions, view_, checked,
        [](const auto* words, Cancel cancel) { return Print(RunView(*words, cancel)); });
    Add(
        "compare", "tell what differs between two .vdb files", &AddCompareOptions, compare_,
        [](const auto& words) { return &words; },
        [](const auto* words, Cancel cancel) { return Compare(*words, cancel); });
  }

  // Commands that tell something.
  void AddQuestions() {
    Add("info", "tell what a .vdb file holds", [this] { return Print(RunInfo(info_path_, json_)); })
        .Add({{.names = "file", .target = &info_path_, .help = "a .vdb file", .value = "OUT.vdb", .required = true},
              JsonRow("as a JSON object", json_)});
    const auto add_call = [this](const char* name, const char* description, auto run) -> CommandParser& {
      CommandParser& command = Add(name, description, [run] {
        const Cancellation cancellation;
        const Interrupt interrupt(cancellation);
        return Print(run(cancellation));
      });
      AddServerOptions(command, server_);
      return command;
    };
    add_call("health", "ask a server whether it takes requests",
             [this](const Cancellation& cancellation) { return RunHealth(server_, cancellation); });
    add_call("limits", "ask a server for its limits", [this](const Cancellation& cancellation) {
      return RunLimits(server_, json_, cancellation);
    }).Add({JsonRow("as a JSON object", json_)});
    Add("completions", "print completions for a shell",
        [this] { return Print(Completions(parser_.Describe(), shell_)); })
        .Add({{.names = "shell",
               .target = &shell_,
               .help = "the shell",
               .words = {"bash", "zsh", "fish"},
               .required = true}});
    Add("man", "print the manual page, as troff reads it", [this] { return Print(ManPageOf(parser_.Describe())); });
  }

  CommandParser parser_{"latvox: triangle meshes to exact sparse voxels on any 3D lattice", "latvox"};
  std::vector<std::pair<CommandParser*, std::function<ExitStatus()>>> runs_;
  VoxelizeWords voxelize_;
  BatchWords batch_;
  PixelizeWords pixelize_;
  EncodeWords encode_;
  MergeWords merge_;
  RenderWords render_;
  SliceWords slice_;
  CompareWords compare_;
  ViewWords view_;
  std::string info_path_, shell_;
  ServerChoice server_;
  bool json_ = false;
};

ExitStatus Main(int argc, char** argv) {
  // Writing to a pipe that nobody reads is an error of that write, not the end.
  signal(SIGPIPE, SIG_IGN);
  // What gRPC would say on standard error comes back in its statuses.
  setenv("GRPC_VERBOSITY", "NONE", /*overwrite=*/0);
  try {
    return Program().Run({argv + 1, argv + argc});
  } catch (const UsageError& error) {
    Tell(absl::StrCat(error.what(), error.is_unknown_word ? "; see latvox --help, latvox COMMAND --help" : ""));
    return ExitStatus::kWrongUsage;
  } catch (const std::exception& error) {
    return Fail(absl::UnknownError(error.what()));
  }
}

}  // namespace
}  // namespace latvox::client

int main(int argc, char** argv) {
  const int status = static_cast<int>(latvox::client::Main(argc, argv));
  if (latvox::client::AnyAbandoned()) _exit(status);
  return status;
}
