// The output .html.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PAGE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PAGE_OUTPUT_H_

#include <functional>
#include <memory>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

using NewVdb = std::function<std::unique_ptr<Output>(std::unique_ptr<AtomicFile>)>;

// Returns an output that makes the page of a .vdb file, which it writes beside the target and removes. So the page is
// that of `latvox view`.
//   new_vdb   opens the output of the .vdb file
//   options   make_page is set
std::unique_ptr<Output> NewPageOutput(std::unique_ptr<AtomicFile> file, const OutputOptions& options, NewVdb new_vdb);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PAGE_OUTPUT_H_
