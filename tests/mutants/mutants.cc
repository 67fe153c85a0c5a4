// Damages files, and reads each as the tool does. Usage: latvox_mutants FOLDER COUNT SEED BAD
//   FOLDER  whole files; the extension of each chooses its readers
//   COUNT   mutants of each file
//   SEED    of the random choices
//   BAD     folder for files that broke a promise
//
// Each mutant has a process of its own, which must end with exit status 0 or 3 within limits of time and memory, and
// leave no output unless the status is 0. Prints a row for each file, and the promise that each bad file broke.
//
// The start of a program that has OpenVDB takes longer than everything else. So commands read a tenth of the grids'
// files. A copy of this process reads the others, confined as ReaderProcess would confine a new program, but with less
// memory: one in ten takes all that it gets.
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <new>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/mesh_source.h"
#include "client/tool/cli/commands.h"
#include "client/tool/cli/compare_command.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/cli/job_line.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/render_command.h"
#include "client/tool/cli/slice_command.h"
#include "client/tool/cli/view_command.h"
#include "client/tool/confined/content_wire.h"
#include "client/tool/confined/foreign_grid.h"
#include "client/tool/confined/reader_main.h"
#include "client/tool/confined/reader_process.h"
#include "client/tool/curve/curve_file.h"
#include "client/tool/texture/base_color_sampler.h"
#include "client/tool/texture/decode_image.h"
#include "client/tool/vdb/vdb.h"
#include "deploy/process/exhaustion.h"
#include "deploy/process/orderly_end.h"

const latvox::OrderlyEnd latvox::kOrderlyEnd = {"latvox_mutants", 5};

namespace latvox::client {
namespace {

namespace fs = std::filesystem;

// Limits of one mutant. That of addresses is not for files of grids: their reader has one of its own.
constexpr rlim_t kMemory = rlim_t{4} << 30;
constexpr unsigned kSeconds = 100;
constexpr uint64_t kMemoryOfCopy = uint64_t{256} << 20;

// The exit statuses that a mutant may have.
constexpr int kDone = static_cast<int>(ExitStatus::kDone), kBadInput = static_cast<int>(ExitStatus::kBadInput);

// Reads a file; writes to the output, if at all.
using Reader = std::function<absl::Status(const std::string& path, const std::string& output)>;

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

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
  JobParser parser("/", "/");
  absl::Status first;
  for (std::string line; std::getline(file, line);) first.Update(parser.Parse(line).status());
  return first;
}

// Never returns. Becomes the process that ReaderProcess would start.
void ReadInCopy(const std::string& path, int file, int channel, pid_t parent) {
  const int from = fcntl(file, F_DUPFD, kReaderChannel + 1), to = fcntl(channel, F_DUPFD, kReaderChannel + 1);
  if (dup2(from, kReaderFile) < 0 || dup2(to, kReaderChannel) < 0) _exit(kReaderMisused);
  const ReaderLimits limits = ReaderLimitsFor(fs::file_size(path));
  std::string words[] = {"latvox",
                         kReaderArgument,
                         absl::StrCat(parent),
                         absl::StrCat(kMemoryOfCopy),
                         absl::StrCat(limits.seconds),
                         kReadContent,
                         path};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  ReadForParent(arguments.data(), [] {});
}

// Crashes and nonsense count as refusals, as ReaderProcess::Blame tells them.
absl::Status Copy(const std::string& path, const std::string&) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  int ends[2];
  if (file < 0 || pipe2(ends, O_CLOEXEC) != 0) return absl::InternalError("no file or no pipe");
  const pid_t parent = getpid(), child = fork();
  if (child == 0) ReadInCopy(path, file, ends[1], parent);
  close(ends[1]);
  const auto content = ReceiveContent(/*facts_alone=*/false, [&](void* to, size_t bytes) {
    for (ssize_t got = 0; bytes > 0; bytes -= static_cast<size_t>(got)) {
      got = read(ends[0], to, bytes);
      if (got <= 0) return absl::DataLossError("the copy has ended");
      to = static_cast<char*>(to) + got;
    }
    return absl::OkStatus();
  });
  close(ends[0]);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child) return absl::InternalError("no copy");
  if (WIFEXITED(status) && WEXITSTATUS(status) == kReaderMisused) return absl::InternalError("the copy did not start");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) return absl::InternalError("the copy was killed");
  return absl::IsDataLoss(content.status()) ? absl::InvalidArgumentError("damaged") : content.status();
}

// Too many pixels are a fault of the image here.
absl::Status Refused(const absl::Status& status) {
  return absl::IsResourceExhausted(status) ? absl::InvalidArgumentError(status.message()) : status;
}

absl::Status Image(const std::string& path, const std::string&) { return Refused(DecodeImage(BytesOf(path)).status()); }

// Reads a mesh with its textures.
absl::Status Textures(const std::string& path, const std::string&) {
  auto read = ReadMeshSource({.paths = {path}, .format = {}, .base_colors = true});
  if (!read.ok()) return read.status();
  std::vector<Warning> warnings;
  const auto mesh = std::make_shared<Mesh>(std::get<Mesh>(*std::move(read)));
  auto sampler = BaseColorSampler::Create(mesh, /*skip_bad=*/false, warnings);
  for (size_t t = 0; sampler.ok() && t < mesh->triangles.size(); ++t) sampler->At(t, {0.25, 0.25}, 1);
  return Refused(sampler.status());
}

const std::vector<Reader>& ReadersOf(const std::string& extension) {
  static const std::vector<Reader> kOfGrids = {Info, Align, Merge, Compare, Render, Slice, View};
  static const std::map<std::string, std::vector<Reader>> kReaders = {
      {".vdb", kOfGrids}, {".nvdb", kOfGrids}, {".glb", {Info, Textures}}, {".png", {Info, Image}}, {".jpg", {Image}},
      {".webp", {Image}}, {".svg", {Draw}},    {".txt", {Draw}},           {".jsonl", {Jobs}}};
  static const std::vector<Reader> kInfo = {Info};
  const auto found = kReaders.find(extension);
  return found == kReaders.end() ? kInfo : found->second;
}

bool IsGrid(const std::string& extension) { return extension == ".vdb" || extension == ".nvdb"; }

const Reader& ReaderOf(const std::string& extension, int mutant) {
  static const Reader kCopy = Copy;
  const auto& readers = ReadersOf(extension);
  const bool is_grid = IsGrid(extension);
  if (is_grid && mutant % 10 != 0) return kCopy;
  return readers[static_cast<size_t>(is_grid ? mutant / 10 : mutant) % readers.size()];
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

// The end of one mutant's process, and its cost.
struct Trial {
  int status = -1;  // by wait4; -1: no process could be started
  double seconds = 0;
  int64_t kibibytes = 0;  // the most memory of the process, or of the one that read for it
};

Trial Run(const Reader& reader, const fs::path& path, const fs::path& outputs) {
  fs::remove_all(outputs);
  fs::create_directory(outputs);
  const auto began = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    EndAsUsual();
    const rlimit memory{kMemory, kMemory};
    if (!IsGrid(path.extension())) setrlimit(RLIMIT_AS, &memory);
    alarm(kSeconds);
    _exit(StatusOfReader(reader, path, outputs / "out"));
  }
  Trial trial;
  rusage usage{};
  if (child < 0 || wait4(child, &trial.status, 0, &usage) != child) return {};
  trial.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  trial.kibibytes = usage.ru_maxrss;
  return trial;
}

// A mutant of a file that nobody reads tells nothing.
bool IsReadable(const fs::path& whole, const std::vector<Reader>& readers, const fs::path& outputs) {
  return std::any_of(readers.begin(), readers.end(),
                     [&](const Reader& reader) { return Run(reader, whole, outputs).status == 0; });
}

// Returns the promise that was broken, or nothing.
std::string BrokenPromise(const Trial& trial, const fs::path& outputs) {
  if (trial.status == -1) return "no process could be started";
  if (WIFSIGNALED(trial.status)) return "ended with signal " + std::to_string(WTERMSIG(trial.status));
  if (static_cast<rlim_t>(trial.kibibytes) << 10 > kMemory) return "took " + std::to_string(trial.kibibytes) + " KiB";
  const int code = WEXITSTATUS(trial.status);
  if (code != kDone && code != kBadInput) return "exit status " + std::to_string(code);
  if (code != kDone && !fs::is_empty(outputs)) return "left an output, with exit status " + std::to_string(code);
  return "";
}

// Counts of one file's mutants, and the most that one of them cost.
struct Row {
  int refused = 0, bad = 0;
  double slowest = 0;
  int64_t kibibytes = 0;

  void Add(const Trial& trial) {
    refused += WIFEXITED(trial.status) && WEXITSTATUS(trial.status) == kBadInput;
    slowest = std::max(slowest, trial.seconds);
    kibibytes = std::max(kibibytes, trial.kibibytes);
  }
};

// Returns the number of bad mutants.
int TryMutantsOf(const fs::path& whole, int count, uint64_t seed, const fs::path& bad) {
  const std::string bytes = BytesOf(whole), extension = whole.extension();
  const fs::path path = bad / ("mutant" + extension), outputs = bad / "outputs";
  const auto start = std::chrono::steady_clock::now();
  Row row;
  if (!IsReadable(whole, ReadersOf(extension), outputs)) {
    std::printf("%s: no reader accepts the whole file\n", whole.c_str());
    ++row.bad;
  }
  for (int n = 0; n < count; ++n) {
    Write(path, Damage(seed + static_cast<uint64_t>(n)).Of(bytes));
    const Trial trial = Run(ReaderOf(extension, n), path, outputs);
    row.Add(trial);
    const std::string broken = BrokenPromise(trial, outputs);
    if (broken.empty()) continue;
    const fs::path kept = bad / (whole.stem().string() + "-" + std::to_string(n) + extension);
    fs::copy_file(path, kept, fs::copy_options::overwrite_existing);
    std::printf("%s: %s\n", kept.c_str(), broken.c_str());
    ++row.bad;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("| %s | %d | %d | %d | %.1f | %.2f | %ld |\n", whole.filename().c_str(), count, row.refused, row.bad,
              seconds, row.slowest, row.kibibytes >> 10);
  std::fflush(stdout);
  fs::remove(path);
  fs::remove_all(outputs);
  return row.bad;
}

int Main(int argc, char** argv) {
  int count = 0;
  uint64_t seed = 0;
  if (argc != 5 || !absl::SimpleAtoi(argv[2], &count) || !absl::SimpleAtoi(argv[3], &seed)) {
    return std::fputs("usage: latvox_mutants FOLDER COUNT SEED BAD\n", stderr), 2;
  }
  // Each copy of this process would take longer to load it than to read a file.
  if (const auto vdb = Vdb::Load(); !vdb.ok()) return std::puts(vdb.status().ToString().c_str()), 2;
  const fs::path bad = argv[4];
  fs::create_directories(bad);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(argv[1])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::printf("| file | mutants | refused | bad | seconds | slowest | MiB |\n|---|---|---|---|---|---|---|\n");
  int wrong = 0;
  for (const fs::path& file : files) wrong += TryMutantsOf(file, count, seed, bad);
  return wrong == 0 && !files.empty() ? 0 : 1;
}

}  // namespace
}  // namespace latvox::client

int main(int argc, char** argv) {
  if (latvox::client::IsReader(argc, argv)) latvox::client::ReadForParent(argv, latvox::EndAsUsual);
  return latvox::client::Main(argc, argv);
}
