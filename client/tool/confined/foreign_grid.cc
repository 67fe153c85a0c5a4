#include "client/tool/confined/foreign_grid.h"

#include <utility>

#include "absl/time/clock.h"
#include "client/tool/confined/content_wire.h"
#include "client/tool/confined/reader_main.h"
#include "client/tool/confined/reader_process.h"

namespace latvox::client {
namespace {

// A busy system may lack memory or threads for a moment. Then it fails the process, whatever the file holds.
constexpr int kAttempts = 3;
constexpr absl::Duration kPause = absl::Milliseconds(300);

absl::StatusOr<GridContent> Read(const std::string& path, const char* what, const Cancellation& cancellation) {
  for (int attempt = 1;; ++attempt) {
    const auto process = ReaderProcess::Start(path, what, cancellation);
    if (!process.ok()) return process.status();
    auto content = ReceiveContent(what == kReadInfo,
                                  [&process](void* to, size_t bytes) { return (*process)->Receive(to, bytes); });
    if (!absl::IsDataLoss(content.status())) return content;
    const absl::Status blame = (*process)->Blame();
    if (!absl::IsResourceExhausted(blame) || attempt == kAttempts) return blame;
    absl::SleepFor(kPause);
    if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  }
}

}  // namespace

absl::StatusOr<GridFileInfo> ReadForeignInfo(const std::string& path, const Cancellation& cancellation) {
  auto content = Read(path, kReadInfo, cancellation);
  if (!content.ok()) return content.status();
  return std::move(content->file.info);
}

absl::StatusOr<GridContent> ReadForeignContent(const std::string& path, bool values, const Cancellation& cancellation) {
  return Read(path, values ? kReadContent : kReadVoxels, cancellation);
}

}  // namespace latvox::client
