// Outputs that list voxels one after the other: .csv, .npy, .ply.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_TABLE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_TABLE_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"
#include "latvox/types.h"

namespace latvox::client {

// What a row has besides the voxel's place.
struct TableColumns {
  bool distances = false;                  // of a band, whose batches have values
  std::vector<Attribute> attributes = {};  // that voxels carry
};

std::unique_ptr<Output> NewCsvOutput(std::unique_ptr<AtomicFile> file, const TableColumns& columns);
std::unique_ptr<Output> NewNpyOutput(std::unique_ptr<AtomicFile> file, const TableColumns& columns);
std::unique_ptr<Output> NewPlyOutput(std::unique_ptr<AtomicFile> file, const TableColumns& columns);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_TABLE_OUTPUT_H_
