// Files of VTK's XML formats.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VTK_FILE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VTK_FILE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/packed_blocks.h"
#include "latvox/types.h"

namespace latvox::client {

// One DataArray.
struct VtkArray {
  std::string name, type;  // type: "Float32"
  size_t components;
  uint64_t bytes;  // in all
  NextChunk next;
};

// An element with arrays, such as CellData.
struct VtkSection {
  std::string name;
  std::vector<VtkArray> arrays;
};

struct VtkFile {
  std::string kind;        // "ImageData"
  std::string attributes;  // of the element of this name
  std::string piece;       // attributes of its only piece
  std::vector<VtkSection> sections;
};

// Returns the name of a component's type; kUint32 stands for int32.
const char* VtkTypeOf(NumberType type);

// Writes the file. Arrays are appended, raw, in PackedBlocks, which are in memory a few at a time. Errors: those of
// AtomicFile; RESOURCE_EXHAUSTED (memory). Precondition: nothing has been written.
absl::Status WriteVtkFile(const VtkFile& vtk, AtomicFile& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VTK_FILE_H_
