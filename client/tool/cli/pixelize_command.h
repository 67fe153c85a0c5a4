// `latvox pixelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_PIXELIZE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_PIXELIZE_COMMAND_H_

#include "absl/status/statusor.h"
#include "client/tool/cli/pixelize_options.h"
#include "client/tool/cli/report.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Reads the drawing, lets the server pixelize it and writes every output. The outputs appear only if everything
// succeeded. Otherwise existing files stay as they are, and nothing else is left.
absl::StatusOr<PixelizeReport> RunPixelize(const PixelizeOptions& options, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PIXELIZE_COMMAND_H_
