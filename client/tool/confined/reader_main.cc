#include "client/tool/confined/reader_main.h"

#include <sched.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <cerrno>
#include <ext/stdio_filebuf.h>
#include <istream>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/tool/confined/content_wire.h"
#include "client/tool/confined/hdf5_info.h"
#include "client/tool/confined/reader_process.h"
#include "client/tool/confined/reader_sandbox.h"
#include "client/tool/hdf5/hdf5_library.h"
#include "client/tool/vdb/vdb.h"
#include "deploy/process/exhaustion.h"

namespace latvox::client {
namespace {

constexpr size_t kBufferBytes = size_t{1} << 16;
constexpr int kArguments = 7;  // program, kReaderArgument, parent, memory, seconds, what, path

// A pipe may get no page for a moment. The limit of processor time ends the wait.
bool MayPass(int error) { return error == EINTR || error == ENOMEM; }

// Collects small pieces, because each write is a system call.
class Channel {
 public:
  void Send(const void* from, size_t bytes) {
    const char* at = static_cast<const char*>(from);
    if (buffer_.size() + bytes > kBufferBytes) Flush();
    if (bytes > kBufferBytes) return Write(at, bytes);
    buffer_.append(at, bytes);
  }
  void Flush() {
    Write(buffer_.data(), buffer_.size());
    buffer_.clear();
  }

 private:
  static void Write(const char* at, size_t bytes) {
    while (bytes > 0) {
      const ssize_t sent = write(kReaderChannel, at, bytes);
      if (sent < 0 && !MayPass(errno)) _exit(kReaderCannotSend + errno);
      if (sent < 0) {
        sched_yield();
        continue;
      }
      at += sent;
      bytes -= static_cast<size_t>(sent);
    }
  }

  std::string buffer_;
};

// A .h5 needs no `vdb`.
absl::StatusOr<GridContent> Read(const Vdb* vdb, std::istream& in, const std::string& what, const std::string& path) {
  if (what == kReadVoxels || what == kReadContent) return vdb->ReadContent(in, path, /*values=*/what == kReadContent);
  auto info = vdb == nullptr ? ReadHdf5Info(kReaderFile, path) : vdb->ReadInfo(in, path);
  if (!info.ok()) return info.status();
  return GridContent{{*std::move(info), {}}};
}

absl::StatusOr<GridContent> CannotConfine(const std::string& path, const absl::Status& reason) {
  return absl::ResourceExhaustedError(
      absl::StrCat(path, ": the process that reads it cannot give up its rights: ", reason.message()));
}

}  // namespace

bool IsReader(int argc, char** argv) { return argc == kArguments && argv[1] == std::string(kReaderArgument); }

void ReadForParent(char** argv, void (*when_loaded)()) {
  int parent = 0;
  ReaderLimits limits;
  if (!absl::SimpleAtoi(argv[2], &parent) || !absl::SimpleAtoi(argv[3], &limits.memory) ||
      !absl::SimpleAtoi(argv[4], &limits.seconds)) {
    _exit(kReaderMisused);
  }
  // TBB looks around in the system when it is first used, and would start threads.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  tbb::parallel_for(0, 2, [](int) {});
  // Libraries open files while they are loaded.
  const Vdb* vdb = nullptr;
  if (argv[5] == std::string(kReadHdf5)) {
    static_cast<void>(Hdf5::Load());  // errors come later
  } else {
    const auto loaded = Vdb::Load();
    if (!loaded.ok()) _exit(kReaderLacksLibrary);
    vdb = *loaded;
  }
  when_loaded();
  // It asks the system about the file.
  __gnu_cxx::stdio_filebuf<char> buffer(kReaderFile, std::ios::in | std::ios::binary, kBufferBytes);
  std::istream in(&buffer);
  const bool has_own_limit = AddressLimit() != UINT64_MAX;
  const absl::Status confined = ConfineReader(parent, limits);
  const auto content = confined.ok() ? Read(vdb, in, argv[5], argv[6]) : CannotConfine(argv[6], confined);
  if (confined.ok() && content.status().code() == absl::StatusCode::kResourceExhausted && !has_own_limit)
    _exit(kReaderOutOfMemory);
  Channel channel;
  SendContent(content, [&channel](const void* from, size_t bytes) { channel.Send(from, bytes); });
  channel.Flush();
  _exit(kReaderDone);
}

}  // namespace latvox::client
