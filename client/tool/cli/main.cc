// The command line tool `latvox`.
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
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

// The commands and what parsing them fills.
struct Commands {
  CLI::App app{"latvox: triangle meshes to exact sparse voxels on any 3D lattice", "latvox"};
  VoxelizeWords words;
  BatchWords batch_words;
  PixelizeWords pixelize_words;
  EncodeWords encode_words;
  MergeWords merge_words;
  RenderWords render_words;
  SliceWords slice_words;
  CompareWords compare_words;
  ViewWords view_words;
  std::string info_path, shell;
  ServerChoice server;
  bool json = false;
  CLI::App* voxelize = app.add_subcommand("voxelize", "voxelize a mesh file");
  CLI::App* batch = app.add_subcommand("batch", "voxelize many mesh files");
  CLI::App* pixelize = app.add_subcommand("pixelize", "pixelize a drawing: the same in the plane");
  CLI::App* encode = app.add_subcommand("encode", "write mesh files as one Draco file, as servers take it");
  CLI::App* merge =
      app.add_subcommand("merge", "join parts of a voxelization: .vdb files of --region, --bounds or --shard");
  CLI::App* render = app.add_subcommand("render", "draw a picture of a .vdb file's voxels");
  CLI::App* slice = app.add_subcommand("slice", "draw one layer of a .vdb file's voxels, or list them");
  CLI::App* view = app.add_subcommand("view", "make a page that shows a .vdb file's voxels in a browser");
  CLI::App* compare = app.add_subcommand("compare", "tell what differs between two .vdb files");
  CLI::App* info = app.add_subcommand("info", "tell what a .vdb file holds");
  CLI::App* health = app.add_subcommand("health", "ask a server whether it takes requests");
  CLI::App* limits = app.add_subcommand("limits", "ask a server for its limits");
  CLI::App* completions = app.add_subcommand("completions", "print completions for a shell");
  CLI::App* man = app.add_subcommand("man", "print the manual page, as troff reads it");

  Commands() {
    app.set_version_flag("--version", "latvox " LATVOX_VERSION);
    app.require_subcommand(0, 1);
    AddVoxelizeOptions(*voxelize, words);
    AddBatchOptions(*batch, batch_words);
    AddPixelizeOptions(*pixelize, pixelize_words);
    AddEncodeOptions(*encode, encode_words);
    AddMergeOptions(*merge, merge_words);
    AddRenderOptions(*render, render_words);
    AddSliceOptions(*slice, slice_words);
    AddViewOptions(*view, view_words);
    AddCompareOptions(*compare, compare_words);
    info->add_option("file", info_path, "a .vdb file")->type_name("OUT.vdb")->required();
    info->add_flag("--json", json, "as a JSON object");
    AddServerOptions(*health, server);
    AddServerOptions(*limits, server);
    limits->add_flag("--json", json, "as a JSON object");
    completions->add_option("shell", shell, "the shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
    AddFooters(app);
  }
};

std::string Completions(const CLI::App& app, const std::string& shell) {
  const CommandFacts facts = Describe(app);
  return shell == "bash" ? BashCompletions(facts) : shell == "zsh" ? ZshCompletions(facts) : FishCompletions(facts);
}

ExitStatus Run(const Commands& commands) {
  const Cancellation cancellation;
  if (*commands.completions) return Print(Completions(commands.app, commands.shell));
  if (*commands.man) return Print(ManPageOf(commands.app));
  if (*commands.info) return Print(RunInfo(commands.info_path, commands.json));
  if (*commands.voxelize) {
    const VoxelizeOptions options = Interpret(commands.words);
    const Interrupt interrupt(cancellation);
    return Print(Voxelize(options, cancellation));
  }
  if (*commands.batch) {
    const BatchOptions options = Interpret(commands.batch_words);
    const Interrupt interrupt(cancellation);
    return Batch(options, cancellation);
  }
  if (*commands.pixelize) {
    const PixelizeOptions options = Interpret(commands.pixelize_words);
    const Interrupt interrupt(cancellation);
    return Print(Pixelize(options, cancellation));
  }
  if (*commands.encode) {
    const MeshSource source = Interpret(commands.encode_words);
    const Interrupt interrupt(cancellation);
    return Print(RunEncode(commands.encode_words, source, cancellation));
  }
  if (*commands.merge) {
    Check(commands.merge_words);
    const Interrupt interrupt(cancellation);
    return Print(RunMerge(commands.merge_words, cancellation));
  }
  if (*commands.render) {
    PictureOptions options = Interpret(commands.render_words);
    options.cancellation = cancellation;
    const Interrupt interrupt(cancellation);
    return Print(RunRender(commands.render_words, options));
  }
  if (*commands.slice) {
    Check(commands.slice_words);
    const Interrupt interrupt(cancellation);
    return Print(RunSlice(commands.slice_words, cancellation));
  }
  if (*commands.view) {
    Check(commands.view_words);
    const Interrupt interrupt(cancellation);
    return Print(RunView(commands.view_words, cancellation));
  }
  const Interrupt interrupt(cancellation);
  if (*commands.compare) return Compare(commands.compare_words, cancellation);
  if (*commands.health) return Print(RunHealth(commands.server, cancellation));
  if (*commands.limits) return Print(RunLimits(commands.server, commands.json, cancellation));
  return Print(Introduction());
}

// The words after the program's name, the last first, as CLI11 wants vectors; "help COMMAND" is "COMMAND --help".
std::vector<std::string> Words(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "help") {
    words.erase(words.begin());
    const auto is_known = [&](const CLI::App* command) { return command->check_name(words[0]); };
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    if (words.empty() || std::any_of(commands.begin(), commands.end(), is_known)) words.emplace_back("--help");
  }
  return {words.rbegin(), words.rend()};
}

ExitStatus Main(int argc, char** argv) {
  // Writing to a pipe that nobody reads is an error of that write, not the end.
  signal(SIGPIPE, SIG_IGN);
  // What gRPC would say on standard error comes back in its statuses.
  setenv("GRPC_VERBOSITY", "NONE", /*overwrite=*/0);
  Commands commands;
  try {
    commands.app.parse(Words(commands.app, argc, argv));
    return Run(commands);
  } catch (const CLI::Success& wanted) {  // --help, --version
    commands.app.exit(wanted);
    return ExitStatus::kDone;
  } catch (const CLI::ExtrasError& error) {
    Tell(absl::StrCat(error.what(), "; see latvox --help, latvox COMMAND --help"));
    return ExitStatus::kWrongUsage;
  } catch (const CLI::ParseError& error) {
    Tell(error.what());
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
