#include "client/tool/confined/foreign_grid.h"

#include <utility>

#include "absl/strings/match.h"
#include "client/tool/confined/content_wire.h"
#include "client/tool/confined/reader_main.h"
#include "client/tool/confined/reader_process.h"

namespace latvox::client {
namespace {

absl::StatusOr<GridContent> Read(const std::string& path, const char* what, const Cancellation& cancellation) {
  const auto process = ReaderProcess::Start(path, what, cancellation);
  if (!process.ok()) return process.status();
  auto content = ReceiveContent(what == kReadInfo || what == kReadHdf5,
                                [&process](void* to, size_t bytes) { return (*process)->Receive(to, bytes); });
  return absl::IsDataLoss(content.status()) ? (*process)->Blame() : std::move(content);
}

}  // namespace

absl::StatusOr<GridFileInfo> ReadForeignInfo(const std::string& path, const Cancellation& cancellation) {
  auto content = Read(path, absl::EndsWithIgnoreCase(path, ".h5") ? kReadHdf5 : kReadInfo, cancellation);
  if (!content.ok()) return content.status();
  return std::move(content->file.info);
}

absl::StatusOr<GridContent> ReadForeignContent(const std::string& path, bool values, const Cancellation& cancellation) {
  return Read(path, values ? kReadContent : kReadVoxels, cancellation);
}

}  // namespace latvox::client
