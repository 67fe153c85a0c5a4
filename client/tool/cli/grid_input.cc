#include "client/tool/cli/grid_input.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/grid/open_file.h"
#include "client/mesh_files/mesh_format.h"
#include "client/tool/confined/foreign_grid.h"

namespace latvox::client {
namespace {

template <class T>
absl::StatusOr<T> WithHelp(absl::StatusOr<T> read, const std::string& path) {
  const absl::Status& status = read.status();
  if (!absl::EndsWith(status.message(), kNoGridFile) || !FormatOfPath(path)) return read;
  return absl::Status(status.code(), absl::StrCat(status.message(), "; latvox voxelize reads meshes"));
}

}  // namespace

absl::StatusOr<GridFileInfo> ReadInputInfo(const std::string& path, const Cancellation& cancellation) {
  return WithHelp(ReadForeignInfo(path, cancellation), path);
}

absl::StatusOr<GridContent> ReadInputContent(const std::string& path, bool values, const Cancellation& cancellation) {
  return WithHelp(ReadForeignContent(path, values, cancellation), path);
}

}  // namespace latvox::client
