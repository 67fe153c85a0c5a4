// Damages files, and reads each as the tool does. Usage: latvox_mutants FOLDER COUNT SEED BAD
//   FOLDER  whole files; the extension of each chooses its readers
//   COUNT   mutants of each file
//   SEED    of the random choices
//   BAD     folder for files that broke a promise
//
// Each mutant has a process of its own, which must end with exit status 0, 3 or 5 within limits of time and memory, and
// leave no output unless the status is 0. Prints a row for each file, and the promise that each bad file broke.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <new>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "client/tool/cli/commands.h"
#include "client/tool/cli/compare_command.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/cli/job_line.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/render_command.h"
#include "client/tool/cli/slice_command.h"
#include "client/tool/cli/view_command.h"
#include "client/tool/confined/foreign_grid.h"
#include "client/tool/confined/reader_main.h"
#include "client/tool/curve/curve_file.h"
#include "deploy/process/exhaustion.h"
#include "deploy/process/orderly_end.h"

const latvox::OrderlyEnd latvox::kOrderlyEnd = {"latvox_mutants", 5};

namespace latvox::client {
namespace {

namespace fs = std::filesystem;

// Of one mutant. The reader of .vdb files has limits of its own.
constexpr rlim_t kMemory = rlim_t{4} << 30;
constexpr unsigned kSeconds = 100;

// Reads a file; writes to the output, if at all.
using Reader = std::function<absl::Status(const std::string& path, const std::string& output)>;

absl::Status Info(const std::string& path, const std::string&) { return RunInfo(path, /*json=*/true).status(); }

absl::Status Align(const std::string& path, const std::string&) { return ReadForeignInfo(path).status(); }

absl::Status Merge(const std::string& path, const std::string& output) {
  MergeWords words;
  words.parts = {path};
  words.outputs = {output + ".vdb"};
  return RunMerge(words, {}).status();
}

absl::Status Compare(const std::string& path, const std::string& output) {
  CompareWords words;
  words.a = words.b = path;
  words.outputs = {output + ".vdb"};
  return RunCompare(words, {}).status();
}

absl::Status Render(const std::string& path, const std::string& output) {
  RenderWords words;
  words.input = path;
  words.outputs = {output + ".png"};
  return RunRender(words, Interpret(words)).status();
}

absl::Status Slice(const std::string& path, const std::string& output) {
  SliceWords words;
  words.input = path;
  words.outputs = {output + ".csv", output + ".png"};
  return RunSlice(words, {}).status();
}

absl::Status View(const std::string& path, const std::string& output) {
  ViewWords words;
  words.input = path;
  words.outputs = {output + ".html"};
  return RunView(words, {}).status();
}

absl::Status Draw(const std::string& path, const std::string&) { return ReadCurveFile(path).status(); }

absl::Status Jobs(const std::string& path, const std::string&) {
  std::ifstream file(path);
  const JobParser parser("/", "/");
  absl::Status first;
  for (std::string line; std::getline(file, line);) first.Update(const_cast<JobParser&>(parser).Parse(line).status());
  return first;
}

const std::vector<Reader>& ReadersOf(const std::string& extension) {
  static const std::map<std::string, std::vector<Reader>> kReaders = {
      {".vdb", {Info, Align, Merge, Compare, Render, Slice, View}},
      {".svg", {Draw}},
      {".txt", {Draw}},
      {".jsonl", {Jobs}}};
  static const std::vector<Reader> kInfo = {Info};
  const auto found = kReaders.find(extension);
  return found == kReaders.end() ? kInfo : found->second;
}

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void Write(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

class Damage {
 public:
  explicit Damage(uint64_t seed) : random_(seed) {}

  // A bit, a byte or a number is changed, or bytes are lost, doubled or moved; sometimes several times.
  std::string Of(std::string bytes) {
    for (uint64_t left = 1 + (Below(4) == 0 ? Below(8) : 0); left > 0 && !bytes.empty(); --left) Once(bytes);
    return bytes;
  }

 private:
  uint64_t Below(uint64_t limit) { return random_() % limit; }

  void Once(std::string& bytes) {
    // Headers are short, and worth half of the changes.
    const uint64_t at = Below(Below(2) == 0 ? std::min<uint64_t>(bytes.size(), 2048) : bytes.size());
    const uint64_t length = std::min(1 + Below(64), bytes.size() - at);
    switch (Below(7)) {
      case 0:
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << Below(8));
        break;
      case 2:
        bytes[at] = static_cast<char>(Below(256));
        break;
      case 3:
        Number(bytes, at);
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5:
        bytes.insert(Below(bytes.size()), bytes.substr(at, length));
        break;
      default:
        bytes.erase(at, length);
    }
  }

  // Lengths and counts have 16, 32 or 64 bits.
  void Number(std::string& bytes, uint64_t at) {
    constexpr uint64_t kNumbers[] = {
        0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, ~uint64_t{0} >> 1, ~uint64_t{0}};
    const uint64_t number = kNumbers[Below(std::size(kNumbers))];
    const uint64_t width = std::min<uint64_t>(uint64_t{2} << Below(3), bytes.size() - at);
    for (uint64_t n = 0; n < width; ++n) bytes[at + n] = static_cast<char>(number >> 8 * n);
  }

  std::mt19937_64 random_;
};

int StatusOfReader(const Reader& reader, const std::string& path, const std::string& output) {
  try {
    return static_cast<int>(ExitStatusOf(reader(path, output)));
  } catch (const std::exception& error) {
    return static_cast<int>(ExitStatusOf(StatusOf(error)));
  }
}

// Returns the status by waitpid of a process that reads the file; -1 if none could be started.
int Run(const Reader& reader, const fs::path& path, const fs::path& outputs) {
  fs::remove_all(outputs);
  fs::create_directory(outputs);
  const pid_t child = fork();
  if (child == 0) {
    EndAsUsual();
    const rlimit memory{kMemory, kMemory};
    setrlimit(RLIMIT_AS, &memory);
    alarm(kSeconds);
    _exit(StatusOfReader(reader, path, outputs / "out"));
  }
  int status = 0;
  return child >= 0 && waitpid(child, &status, 0) == child ? status : -1;
}

// A mutant of a file that nobody reads tells nothing.
bool IsReadable(const fs::path& whole, const std::vector<Reader>& readers, const fs::path& outputs) {
  return std::any_of(readers.begin(), readers.end(),
                     [&](const Reader& reader) { return Run(reader, whole, outputs) == 0; });
}

// Returns the promise that was broken, or nothing.
std::string Try(const Reader& reader, const fs::path& path, const fs::path& outputs) {
  const int status = Run(reader, path, outputs);
  if (status == -1) return "no process could be started";
  if (WIFSIGNALED(status)) return "ended with signal " + std::to_string(WTERMSIG(status));
  const int code = WEXITSTATUS(status);
  if (code != 0 && code != 3 && code != 5) return "exit status " + std::to_string(code);
  if (code != 0 && !fs::is_empty(outputs)) return "left an output, with exit status " + std::to_string(code);
  return "";
}

// Returns the number of bad mutants.
int TryMutantsOf(const fs::path& whole, int count, uint64_t seed, const fs::path& bad) {
  const std::string bytes = BytesOf(whole), extension = whole.extension();
  const auto& readers = ReadersOf(extension);
  const fs::path path = bad / ("mutant" + extension), outputs = bad / "outputs";
  const auto start = std::chrono::steady_clock::now();
  double slowest = 0;
  int wrong = 0;
  if (!IsReadable(whole, readers, outputs)) {
    std::printf("%s: no reader accepts the whole file\n", whole.c_str());
    ++wrong;
  }
  for (int n = 0; n < count; ++n) {
    Write(path, Damage(seed + static_cast<uint64_t>(n)).Of(bytes));
    const auto began = std::chrono::steady_clock::now();
    const std::string broken = Try(readers[static_cast<size_t>(n) % readers.size()], path, outputs);
    slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    if (broken.empty()) continue;
    const fs::path kept = bad / (whole.stem().string() + "-" + std::to_string(n) + extension);
    fs::copy_file(path, kept, fs::copy_options::overwrite_existing);
    std::printf("%s, reader %zu: %s\n", kept.c_str(), static_cast<size_t>(n) % readers.size(), broken.c_str());
    ++wrong;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("| %s | %d | %d | %.1f | %.2f |\n", whole.filename().c_str(), count, wrong, seconds, slowest);
  std::fflush(stdout);
  fs::remove(path);
  fs::remove_all(outputs);
  return wrong;
}

int Number(const char* text) { return std::atoi(text); }

int Main(int argc, char** argv) {
  if (argc != 5) return 2;
  const fs::path bad = argv[4];
  fs::create_directories(bad);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(argv[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::printf("| file | mutants | bad | seconds | slowest |\n|---|---|---|---|---|\n");
  int wrong = 0;
  for (const fs::path& file : files)
    wrong += TryMutantsOf(file, Number(argv[2]), static_cast<uint64_t>(Number(argv[3])), bad);
  return wrong == 0 && !files.empty() ? 0 : 1;
}

}  // namespace
}  // namespace latvox::client

int main(int argc, char** argv) {
  if (latvox::client::IsReader(argc, argv)) {
    latvox::EndAsUsual();
    latvox::client::ReadForParent(argv);
  }
  return latvox::client::Main(argc, argv);
}
