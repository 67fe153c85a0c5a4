#include "client/tool/cli/pixelize_command.h"

#include <memory>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "client/mesh_files/input.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/curve/curve_file.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/pixel_output.h"

namespace latvox::client {
namespace {

using Files = std::vector<std::unique_ptr<AtomicFile>>;

absl::StatusOr<Files> CreateFiles(const std::vector<std::string>& paths) {
  Files files;
  for (const std::string& path : paths) {
    auto file = AtomicFile::Create(path);
    if (!file.ok()) return file.status();
    files.push_back(*std::move(file));
  }
  return files;
}

// The path as given decides the format, even if it is a link to a file with another name.
absl::Status Write(const std::string& path, const Drawing& drawing, const Pixelization& pixelization,
                   AtomicFile& file) {
  const auto bytes = EncodePixels(path, drawing, pixelization);
  if (!bytes.ok()) return bytes.status();
  if (auto status = file.Append(*bytes); !status.ok()) return status;
  return file.Sync();
}

}  // namespace

absl::StatusOr<PixelizeReport> RunPixelize(const PixelizeOptions& options, const Cancellation& cancellation) {
  const absl::Time start = absl::Now();
  const CallOptions call = MakeCallOptions(options.server, cancellation);
  PixelizeReport report;
  report.input_path = NameOfInput(options.input);
  report.outputs = options.outputs;
  report.separability = options.request.separability;
  // Outputs come first, so that an unwritable path fails before any work.
  const auto files = CreateFiles(options.outputs);
  if (!files.ok()) return files.status();
  const auto drawing = DoAbandonably([path = options.input] { return ReadCurveFile(path); }, call);
  if (!drawing.ok()) return drawing.status();
  report.polylines = drawing->polylines.size();
  for (const Polyline& polyline : drawing->polylines) report.points += polyline.points.size();
  report.read_ms = absl::ToDoubleMilliseconds(absl::Now() - start);
  auto session = Session::Open(options.server, call);
  if (!session.ok()) return session.status();
  PixelizeRequest request = options.request;
  request.polylines = drawing->polylines;
  auto answer = session->client().Pixelize(request, call);
  if (!answer.ok()) return answer.status();
  session->Disconnect();
  report.answer = *std::move(answer);
  for (size_t n = 0; n < files->size(); ++n) {
    if (auto status = Write(options.outputs[n], *drawing, report.answer, *(*files)[n]); !status.ok()) return status;
  }
  if (auto status = CheckTime(call); !status.ok()) return status;
  for (const auto& file : *files) {
    if (auto status = file->Commit(); !status.ok()) return status;
  }
  report.total_ms = absl::ToDoubleMilliseconds(absl::Now() - start);
  return report;
}

}  // namespace latvox::client
